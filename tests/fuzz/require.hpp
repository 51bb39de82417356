#pragma once
// What must hold for every input. Not assert(): release builds check it too, and libFuzzer keeps the input of an abort.
#include <cstdio>
#include <cstdlib>

#define CORPUSCLE_REQUIRE(condition)                                                                \
  do {                                                                                              \
    if (!(condition)) {                                                                             \
      std::fprintf(stderr, "%s:%d: %s doesn't hold for this input\n", __FILE__, __LINE__, #condition); \
      std::abort();                                                                                 \
    }                                                                                               \
  } while (false)
