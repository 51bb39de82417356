// An analysis as analysis.json (everything) and analysis.md (a page to read); docs/analysis.md describes both.
#pragma once
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "physics/analysis/record.hpp"
#include "physics/analysis/results.hpp"

namespace corpuscle {

inline constexpr const char* analysis_format = "corpuscle-analysis-1";

/// The contents of analysis.json. NaN and infinity become null.
nlohmann::ordered_json analysis_json(const analysis::RunRecord& record, const analysis::Analysis& analysis);

/// The page: numbers with errors, what isn't converged and why, fits, warnings.
std::string analysis_page(const analysis::RunRecord& record, const analysis::Analysis& analysis);

/// What the user chose, as `settings.asked` of the file: to see whether an analysis would come out the same.
nlohmann::ordered_json asked_json(const analysis::AnalysisOptions& options);

/// Parts that the files of sweeps and studies share.
nlohmann::ordered_json fit_json(const statistics::Fit& fit);
/// NaN and infinity become null.
nlohmann::ordered_json json_number(double value);
/// A text as a field of a CSV file: in quotes where it has to be.
std::string csv_field(const std::string& text);
/// "4.690 ± 0.046": the error with two digits, the value to the same place; without an error six digits; "-" for NaN.
std::string with_error(double value, double error);
/// Texts under the heading "Warnings", one a line; nothing without any.
std::string warnings_page(const std::vector<std::string>& warnings);

/// @throws InputError when `path` is there and is no JSON of this format, or isn't there while a file with one of the other endings is: it would be lost.
void require_replaceable(const std::filesystem::path& path, const std::string& format, const std::vector<std::string>& other_endings);

}  // namespace corpuscle
