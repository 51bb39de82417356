// The analysis of one run of a sweep or study.
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>

#include "physics/analysis/results.hpp"

namespace corpuscle::app {

/// What analysis.json of a run says; analyses it first where that file is missing, older than the data, of another version or made with other choices. `was_there`: whether it wasn't.
/// @throws InputError when the run can't be analysed
nlohmann::ordered_json analysed(const std::filesystem::path& run, const analysis::AnalysisOptions& choices, bool* was_there = nullptr);

}  // namespace corpuscle::app
