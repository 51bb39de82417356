// A suspension from the text of a scene, packed and ready to step.
#pragma once
#include <memory>
#include <string>

#include "io/scene.hpp"
#include "physics/packing.hpp"
#include "physics/suspension.hpp"

namespace corpuscle::test {

struct Running {
  Problem problem;
  LatticeParameters lattice;
  std::unique_ptr<Suspension> suspension;
};

inline Running start(const std::string& scene) {
  Running r;
  r.problem = parse_scene(scene, "test.toml");
  r.lattice = to_lattice(r.problem);
  const auto types = make_cell_types(r.problem, r.lattice);
  r.suspension = make_suspension(r.problem, r.lattice, types, place_cells(r.problem, r.lattice, types));
  return r;
}

}  // namespace corpuscle::test
