// What a run that failed has left.
#pragma once
#include <filesystem>
#include <string>

namespace corpuscle {

/// A sentence for a run that failed: up to which step its series can be read in `directory`.
std::string what_is_kept(const std::filesystem::path& directory);

}  // namespace corpuscle
