#include "core/to_host.hpp"

#include <numeric>

#include "core/vertex_vectors.hpp"
#include "tests/catch.hpp"

using namespace corpuscle;

TEST_CASE("Arrays come to the host complete and in order, whatever the size of the staging buffer", "[core]") {
  std::vector<double> numbers(3 * 1000);
  std::iota(numbers.begin(), numbers.end(), 0.5);
  const VertexVectors vectors = to_device(numbers);
  CHECK(to_host(vectors) == numbers);
  for (const std::size_t part : {1u, 7u, 2999u, 3000u, 5000u}) {
    std::vector<double> copy(numbers.size());
    detail::copy_in_parts<double, MemSpace>(vectors.data(), copy.size(), copy.data(), part);
    CHECK(copy == numbers);
  }
  CHECK(to_host(VertexVectors("none", 0)).empty());
}
