// Does summary.json agree with the series that it is the summary of?
#pragma once
#include <filesystem>
#include <functional>
#include <string>

#include "io/output_check.hpp"
#include "io/run_facts.hpp"

namespace corpuscle {

/// Compares steps, number of cells, means and drifts with run.h5, and adds what is wrong to `out`. @returns whether there is such a file
bool check_summary(const std::filesystem::path& path, const RunFacts& run, bool running, const std::function<void(const std::string& file)>& reading,
                   OutputCheck& out);

}  // namespace corpuscle
