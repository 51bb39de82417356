// Inlines everything that the body of a loop calls: one call that stays in it would keep the loop scalar. Not in debug builds, where checks and
// sanitizers would make the compiler take minutes and gigabytes.
#pragma once

#ifdef NDEBUG
#define CORPUSCLE_FLATTEN [[gnu::flatten]]
#else
#define CORPUSCLE_FLATTEN
#endif
