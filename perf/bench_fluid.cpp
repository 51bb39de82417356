// The fluid alone: MLUPS, bytes a node and the fraction of the bandwidth of an in-place update of the same size, which takes turns with it.
#include <fmt/format.h>

#include "perf/report.hpp"
#include "perf/stream.hpp"
#include "perf/timing.hpp"
#include "physics/fluid.hpp"

using namespace corpuscle;
using namespace corpuscle::perf;

namespace {

struct Variant {
  bool single, trt, walls, force;
  std::string name() const {
    return fmt::format("{} {} {}{}", single ? "float" : "double", trt ? "TRT" : "BGK", walls ? "walls" : "periodic", force ? " force" : "");
  }
};

template <class Real>
void measure(Section& section, const Variant& v, std::array<int, 3> nodes) {
  FluidParameters p;
  p.nodes = nodes;
  p.collision = v.trt ? CollisionKind::trt : CollisionKind::bgk;
  p.walls = v.walls;
  p.needs_force = v.force;
  p.halo = v.force ? 2 : 1;
  p.relaxation_time = 0.9;
  const double count = double(nodes[0]) * nodes[1] * nodes[2];
  // Populations are read and written once; force read and cleared, velocity written (four components each).
  const double traffic = sizeof(Real) * (38.0 + (v.force ? 12.0 : 0.0));
  if (count * sizeof(Real) * 60 > 0.8 * available_bytes()) {
    section.note(fmt::format("{}, {} x {} x {}: left out, not enough memory", v.name(), nodes[0], nodes[1], nodes[2]));
    return;
  }
  Fluid<Real> fluid(p);
  fluid.initialise();
  const InPlace update(count * sizeof(Real) * (19 + (v.force ? 8 : 0)));
  const auto step = [&] {
    for (int parity = 0; parity < 2; ++parity) {
      if (v.force) fluid.coupled_steps(1);
      else fluid.collide_stream();
    }
  };
  const auto seconds = interleaved_seconds({step, update}, section.effort());
  const double rate = 2 * count / seconds[0], bandwidth = update.traffic() / seconds[1];
  const std::string title = fmt::format("{}, {} x {} x {}", v.name(), nodes[0], nodes[1], nodes[2]);
  section.row(title, {{"model", v.name()},
                      {"nodes", nodes},
                      {"MLUPS", rate / 1e6},
                      {"bytes_per_node", double(fluid.bytes()) / count},
                      {"traffic_B", traffic},
                      {"in_place_GB_s", bandwidth / 1e9},
                      {"fraction", rate * traffic / bandwidth}});
}

void measure(Section& section, const Variant& v, std::array<int, 3> nodes) {
  if (v.single)
    measure<float>(section, v, nodes);
  else
    measure<double>(section, v, nodes);
}

}  // namespace

int main(int argc, char** argv) {
  Section section(argc, argv, "fluid", "Fluid alone. fraction: traffic over that of an in-place update of as many bytes, measured in turns.",
                  {{"MLUPS", "higher"}});
  Kokkos::ScopeGuard scope(argc, argv);
  const std::array<int, 3> base = section.effort().quick ? std::array{16, 12, 10} : std::array{128, 128, 128};
  for (const bool single : {true, false})
    for (const bool trt : {false, true})
      for (const auto& [walls, force] : {std::pair{false, false}, {true, false}, {true, true}}) measure(section, {single, trt, walls, force}, base);
  if (section.effort().quick) return section.finish();
  // From the caches to 256^3, powers of two and others; then rows of 32 to 400 nodes, about 2 M nodes each.
  const std::vector<std::array<int, 3>> sizes{{32, 32, 32},   {64, 64, 64},   {100, 100, 100}, {127, 129, 125}, {180, 90, 90}, {200, 200, 200}, {256, 256, 256},
                                              {32, 256, 256}, {48, 208, 208}, {63, 181, 183},  {96, 148, 148},  {250, 92, 92}, {400, 72, 72}};
  for (const auto& nodes : sizes)
    for (const bool single : {true, false}) {
      measure(section, {single, false, false, false}, nodes);
      measure(section, {single, false, true, true}, nodes);
    }
  return section.finish();
}
