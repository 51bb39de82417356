// Where --output points to.
#pragma once
#include <filesystem>

namespace corpuscle::app {

/// Refuses directories that cannot be written, or that another process holds the lock of; creates nothing. @throws InputError
void require_writable(const std::filesystem::path& directory);
/// With those above it. @throws InputError
void create_output_directory(const std::filesystem::path& directory);

}  // namespace corpuscle::app
