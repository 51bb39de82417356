// The main program of every test executable: Kokkos for the whole session, then Catch2 of either major version.
#define CATCH_CONFIG_RUNNER
#include "tests/catch.hpp"

#include <Kokkos_Core.hpp>

#include <algorithm>
#include <string_view>

int main(int argc, char* argv[]) {
  const bool only_lists = std::any_of(argv, argv + argc, [](std::string_view word) { return word.starts_with("--list"); });
  if (only_lists) {
    const int code = Catch::Session().run(argc, argv);
    // Catch2 2 returns the number of tests, and its CMake script complains about 0, as when none is tagged [slow].
    return CATCH_VERSION_MAJOR == 2 ? std::clamp(code, 1, 255) : code;
  }
  Kokkos::ScopeGuard kokkos(argc, argv);
  return Catch::Session().run(argc, argv);
}
