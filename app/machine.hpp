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
std::int64_t total_memory_bytes();      ///< that this process may use: of the machine, or of its control group; 0: unknown
std::int64_t available_memory_bytes();  ///< what of it is free or can be freed now; 0: unknown
/// Gives freed blocks of a MiB or more back to the system at once. glibc learns from the first large block to keep them, and the
/// peak of a run would depend on chance.
void return_freed_memory();

}  // namespace corpuscle::app
