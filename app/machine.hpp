// What the program runs on.
#pragma once
#include <cstdint>
#include <string>

namespace corpuscle::app {

std::string cpu_model();           ///< "unknown" where the system does not tell
std::int64_t cpu_cores();
std::string operating_system();
std::string kokkos_configuration();  ///< Kokkos must be running
std::int64_t peak_memory_bytes();    ///< of this process so far
/// Gives freed blocks of a MiB or more back to the system at once. glibc learns from the first large block to keep them, and the
/// peak of a run would depend on chance.
void return_freed_memory();

}  // namespace corpuscle::app
