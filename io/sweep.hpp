// Sweep files: a base scene and the values that vary (docs/sweep.md is the reference). What they stand for is a list of points, each the scene with overrides.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace corpuscle {

/// One change of a scene, as `run --set KEY=VALUE`.
struct Override {
  std::string key;    ///< "cells.0.count"
  std::string value;  ///< in TOML syntax; a sweep allows numbers, strings, true, false and lists of them, whose text is the same in JSON
  std::string text() const { return key + "=" + value; }
  bool operator==(const Override&) const = default;
};

/// One scene of a sweep.
struct SweepPoint {
  std::string name;                 ///< for its directory: letters, digits, `.`, `-`, `+`, `_`
  std::vector<Override> overrides;  ///< of axes and [[also]] first, then of [[where]]
  std::size_t given = 0;            ///< how many are of axes and [[also]]
  /// As read_scene() takes them.
  std::vector<std::string> texts() const {
    std::vector<std::string> list;
    for (const Override& o : overrides) list.push_back(o.text());
    return list;
  }
};

/// One axis: a key and its values, or a name and settings that change several keys together.
struct SweepAxis {
  struct Setting {
    std::string label;               ///< of a key: the value
    std::vector<Override> overrides;
  };
  std::string name;  ///< or the key
  bool is_key = true;
  std::vector<Setting> settings;
};

struct Sweep {
  std::string scene;               ///< path of the base scene
  std::vector<SweepAxis> axes;
  std::vector<SweepPoint> points;  ///< the matrix of the axes, the last one running fastest, then [[also]]
};

/// Most points of a sweep.
inline constexpr std::size_t most_sweep_points = 10'000;

/// @throws InputError with one sentence: where, what is wrong, what is allowed. The scenes themselves are not looked at.
Sweep read_sweep(const std::string& path);
/// The same for a sweep in memory; `origin` names it in messages, and the scene is beside it. `more`: a table beside those of a sweep that is left to somebody else.
Sweep parse_sweep(std::string_view text, const std::string& origin, std::string_view more = {});

/// Readable names of points from the values that vary among them: "phi0.45-Ca0.0028". `given` has the overrides of each point.
/// Keys appear in the order in which they come first; "base" where nothing varies. Names can coincide, for example when two strings differ in a blank only.
std::vector<std::string> sweep_names(const std::vector<std::vector<Override>>& given);

}  // namespace corpuscle
