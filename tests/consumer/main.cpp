#include "core/version.hpp"

#include <Kokkos_Core.hpp>

#include <cstdio>

int main(int argc, char* argv[]) {
  Kokkos::ScopeGuard kokkos(argc, argv);
  std::printf("corpuscle %s\n", corpuscle::version_string().c_str());
}
