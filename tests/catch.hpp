#pragma once
// The one include for tests; works with Catch2 2.13 and Catch2 3. Approx and the floating-point matchers are in scope.

#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>
using Catch::Approx;
#else
#include <catch2/catch.hpp>
#endif

using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;
