// Can a run be resumed? Reads its checkpoints and tells from where `corpuscle resume` would go on.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "io/output_check.hpp"
#include "io/run_facts.hpp"

namespace corpuscle {

/// Verifies the hashes of both checkpoints, and that what they hold fits to the run and to its series, as `corpuscle resume` asks for.
/// `with_series`: the series is compared too.
/// @returns the step of the newest one that is good, -1 when there is none
std::int64_t check_checkpoints(const std::filesystem::path& directory, const RunFacts& run, bool with_series, const std::set<std::string>& skip,
                               const std::function<void(const std::string& file)>& reading, std::vector<OutputProblem>& problems);

}  // namespace corpuscle
