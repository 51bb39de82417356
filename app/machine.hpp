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

}  // namespace corpuscle::app
