// A study of error against cost with all that follows from it: tradeoff.json, .csv and .md (docs/tradeoff.md).
#pragma once
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "io/study.hpp"
#include "physics/tradeoff.hpp"

namespace corpuscle {

inline constexpr const char* tradeoff_format = "corpuscle-tradeoff-1";

/// A point of a study: settings, what was counted, and how its runs stand.
struct StudyEntry {
  tradeoff::Point point;
  std::vector<std::string> runs;      ///< directories of its repeats, in that of the study
  std::string state;                  ///< finished, refused (`message`), failed (`message`), or what is left to do
  std::string message;
  double nodes = 0, vertices = 0;     ///< of the whole scene
  double steps_per_strain = 0;
  double measured = statistics::not_a_number;  ///< core seconds a unit of strain that the runs took
};

struct StudyResult {
  Study study;
  std::vector<StudyEntry> entries;
  std::vector<tradeoff::Point> points;           ///< those of the entries, in their order
  tradeoff::Reference reference;
  std::vector<std::string> reference_from;       ///< of each observable, in words
  std::vector<statistics::CommonLimit> limits;   ///< of each observable, where the reference is an extrapolation
  std::vector<std::vector<std::string>> families;  ///< settings of the families of `limits`; that of the knob itself is empty
  std::vector<tradeoff::Deviation> deviations;
  std::vector<std::size_t> front;
  std::vector<tradeoff::Order> orders;
  std::vector<tradeoff::KnobStep> steps;
  std::vector<tradeoff::Limit> limiting;
  std::vector<std::string> warnings;
  std::string machine{};                         ///< for which the costs are predicted
};

/// Reference, deviations, front, orders, steps and limiting knobs from what was observed.
StudyResult evaluate(Study study, std::vector<StudyEntry> entries);

nlohmann::ordered_json tradeoff_json(const StudyResult& result);
/// One line a point; empty where there is nothing.
std::string tradeoff_csv(const StudyResult& result);
std::string tradeoff_page(const StudyResult& result);

}  // namespace corpuscle
