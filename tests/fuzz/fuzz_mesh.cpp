// Any file as an OFF mesh: it's refused with InputError, or gives a closed surface of the radius asked for.
#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "physics/mesh.hpp"
#include "tests/fuzz/input_file.hpp"
#include "tests/fuzz/require.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace corpuscle;
  static InputFile file("mesh.off");
  Mesh mesh;
  try {
    mesh = read_off(file.write(bytes, size).string(), 8.0);
  } catch (const InputError&) {
    return 0;
  }
  double farthest = 0;
  for (const Vector3& x : mesh.vertices) {
    CORPUSCLE_REQUIRE(x.allFinite());
    farthest = std::max(farthest, x.norm());
  }
  CORPUSCLE_REQUIRE(std::abs(farthest - 8) < 1e-9);
  CORPUSCLE_REQUIRE(mesh_volume(mesh) > 0 && std::isfinite(mesh_area(mesh)));
  CORPUSCLE_REQUIRE(mesh_edges(mesh).size() == 3 * mesh.faces.size() / 2);
  CORPUSCLE_REQUIRE(one_ring(mesh).vertex_count == static_cast<int>(mesh.vertices.size()));
  return 0;
}
