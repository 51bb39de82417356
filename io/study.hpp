// Study files of `corpuscle tradeoff` (docs/tradeoff.md): a sweep whose axes are the knobs of accuracy, and a table [study] that says what is compared with what.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/sweep.hpp"
#include "physics/statistics/estimate.hpp"

namespace corpuscle {

/// What a study compares with. Exactly one of the three is given.
struct StudyReference {
  /// The limit along this knob, whose settings are numbers that grow with the resolution.
  std::string extrapolate;
  std::vector<std::string> same_limit;  ///< knobs whose settings have that limit in common; all others are those of the base scene
  std::map<std::string, std::string> point;  ///< settings of the knobs of one point; knobs that it leaves out are those of the base scene
  struct Value {
    double value = 0, error = 0;
  };
  std::map<std::string, Value> values;  ///< published ones, by observable
};

/// Numbers of cells are whole, so that no two settings have quite the same volume fraction: observables are taken to this one.
struct StudyFraction {
  double phi = 0;
  std::map<std::string, double> exponents;  ///< by observable: how it grows with the fraction, near this one; others stay
};

struct Study {
  Sweep sweep;
  std::vector<std::string> observables;  ///< names of analysis.json
  double wall_layer = 4;                 ///< as corpuscle analyse --wall-layer
  std::optional<double> discard;         ///< as --discard, strains
  std::optional<StudyFraction> fraction;
  StudyReference reference;
  std::vector<std::string> knobs;                   ///< names of the axes, then keys that only [[also]] changes; run.seed is none
  std::vector<std::vector<std::string>> settings;   ///< [point][knob]: label, or value; that of the base scene where the point doesn't say
  std::vector<std::string> base_settings;           ///< [knob] of the base scene; "base" for an axis none of whose settings it has
};

/// Reads the study and its base scene. @throws InputError with one sentence: where, what is wrong, what is allowed
Study read_study(const std::string& path);
/// The same for a study in memory; `origin` names it in messages, and the scene is beside it.
Study parse_study(std::string_view text, const std::string& origin);

/// The repeats of a study: points that differ in their seed only, in the order of the first of each.
std::vector<std::vector<std::size_t>> repeats_of(const Study& study);

/// An observable of a run whose cells fill `phi`, at the fraction of the study: e ∝ phi^exponent, a viscosity over that of the fluid by what it exceeds 1. Unchanged without an exponent.
statistics::Estimate at_fraction(statistics::Estimate e, const std::string& observable, double phi, const std::optional<StudyFraction>& fraction);

/// Names that a study may observe.
std::vector<std::string> observable_names();

}  // namespace corpuscle
