// An analysis as analysis.json (everything) and analysis.md (a page to read); docs/analysis.md describes both.
#pragma once
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "physics/analysis/record.hpp"
#include "physics/analysis/results.hpp"

namespace corpuscle {

inline constexpr const char* analysis_format = "corpuscle-analysis-1";

/// The contents of analysis.json. NaN and infinity become null.
nlohmann::ordered_json analysis_json(const analysis::RunRecord& record, const analysis::Analysis& analysis);

/// The page: numbers with errors, what isn't converged and why, fits, warnings.
std::string analysis_page(const analysis::RunRecord& record, const analysis::Analysis& analysis);

/// Parts that the analysis of a sweep shares.
nlohmann::ordered_json fit_json(const statistics::Fit& fit);
/// "4.690 ± 0.046": the error with two digits, the value to the same place; without an error six digits; "-" for NaN.
std::string with_error(double value, double error);
/// Texts under the heading "Warnings", one a line; nothing without any.
std::string warnings_page(const std::vector<std::string>& warnings);

/// @throws InputError when there is a file of this name that is no JSON with one of these formats: it would be lost.
void require_replaceable(const std::filesystem::path& path, const std::string& format);

}  // namespace corpuscle
