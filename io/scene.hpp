// Scene files: TOML in, validated Problem out, and back (docs/scene.md is the reference of all keys).
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "physics/problem.hpp"

namespace corpuscle {

/// Reads and validates a scene. `overrides` are `key=value` with dotted keys ("flow.capillary_number=0.05", "cells.0.count=10"), the
/// value in TOML syntax or a bare string. An override replaces the alternatives of its key that the file gives (count for volume_fraction …),
/// and overriding accuracy.preset drops the file's own knobs that the preset sets.
/// @throws InputError with one sentence: where, the key, its value, what is allowed, what to do.
Problem read_scene(const std::string& path, const std::vector<std::string>& overrides = {});

/// The same for a scene in memory. `origin` names it in messages; relative file names in the scene are taken from its directory.
Problem parse_scene(std::string_view text, const std::string& origin, const std::vector<std::string>& overrides = {});

/// The merged scene with every default written out; parse_scene() gives the same Problem back.
std::string to_toml(const Problem& problem);

/// What differs between two scenes, one sentence a key: "run.strain = 10 there, 20 here"; `there` and `here` name the first and the second. Empty: both are the same.
std::vector<std::string> scene_differences(const Problem& first, const Problem& second, std::string_view there, std::string_view here);

/// The value of one key ("cells.0.count") as the merged scene has it; empty where it isn't set. @throws InputError for a key that no scene has, or a cell type that this one hasn't
std::string scene_value(const Problem& problem, const std::string& key);

/// Markdown tables of all keys, one per section, made from the table that drives the reader; docs/scene.md contains them verbatim.
std::string scene_key_reference();

/// Dotted names of all keys; the number of a cell type is written `*` ("cells.*.membrane.bending").
std::vector<std::string> scene_key_names();

}  // namespace corpuscle
