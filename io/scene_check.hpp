// What the table of keys can't say: required keys, contradictions, defaults that depend on other keys.
#pragma once
#include <map>
#include <string>

#include "physics/problem.hpp"

namespace corpuscle::scene {

/// The keys a scene gives, by display path ("cells.0.count"), each with the start of messages about it ("scene.toml:12: ").
using Given = std::map<std::string, std::string>;

/// Fills the defaults that depend on other keys (names, cadences at rest) and refuses contradictory scenes.
/// @throws InputError naming the keys, their values and the way out.
void finish_and_check(Problem& problem, const Given& given, const std::string& origin);

}  // namespace corpuscle::scene
