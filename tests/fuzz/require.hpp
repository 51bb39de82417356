#pragma once
// What must hold for every input. Not assert(): release builds check it too. Ends with SIGILL, of which libFuzzer keeps the input too: SIGABRT may
// also come from the C library, when another library has spoilt its memory.
#include <cstdio>

#define CORPUSCLE_REQUIRE(condition) \
  do { \
    if (!(condition)) { \
      std::fprintf(stderr, "%s:%d: %s doesn't hold for this input\n", __FILE__, __LINE__, #condition); \
      __builtin_trap(); \
    } \
  } while (false)
