// What a scene pays for: the kernels of one step, the bytes a node and a vertex, and what a step allocates, copies and waits for. Prints the table of
// docs/performance.md; nothing is timed.
#include <cstdio>
#include <set>
#include <string>

#include "core/kernel_log.hpp"
#include "io/scene.hpp"
#include "physics/packing.hpp"
#include "physics/suspension.hpp"

using namespace corpuscle;

namespace {

constexpr int warm_up = 3;

/// Labels of arrays by what their size grows with.
bool of_nodes(const std::string& label) { return label == "populations" || label == "force" || label == "velocity"; }
bool of_types(const std::string& label) {
  for (const char* prefix : {"membrane_", "mobility_", "faces", "stretch", "sort_counts", "sort_begin"})
    if (label.rfind(prefix, 0) == 0) return true;
  return false;
}

void report(const char* name, const std::string& scene) {
  const Problem problem = parse_scene(scene, name);
  const LatticeParameters lattice = to_lattice(problem);
  const auto types = make_cell_types(problem, lattice);
  const auto positions = place_cells(problem, lattice, types);
  KernelLog log;
  const auto suspension = make_suspension(problem, lattice, types, positions);
  for (int i = 0; i < warm_up; ++i) suspension->step();
  std::int64_t node_bytes = 0, vertex_bytes = 0;
  for (const auto& [label, bytes] : log.live())
    if (of_nodes(label))
      node_bytes += bytes;
    else if (!of_types(label))
      vertex_bytes += bytes;
  log.clear();
  suspension->step();

  const FluidParameters fluid = fluid_parameters(problem, lattice);
  const double nodes = double(Grid{fluid.nodes[0], fluid.nodes[1], fluid.nodes[2], fluid.halo}.padded_nodes());
  const double vertices = double(positions.size()) / 3;
  std::string kernels;
  std::set<std::string> seen;
  const auto counts = log.counts();
  for (const auto& launch : log.launches())
    if (seen.insert(launch.label).second) {
      const int count = counts.at(launch.label);
      kernels += (kernels.empty() ? "" : "; ") + launch.label + (count > 1 ? " x" + std::to_string(count) : "");
    }
  std::printf("| %s | %zu | %s | %.0f | %s | %zu, %zu, %zu |\n", name, log.launches().size(), kernels.c_str(), double(node_bytes) / nodes,
              vertices > 0 ? std::to_string(int(double(vertex_bytes) / vertices + 0.5)).c_str() : "-", log.allocated().size(), log.copies().size(),
              log.fences().size());
}

/// Twenty spheres between walls with as little physics as a cell can have, plus lines for the tables.
std::string capsules(const std::string& accuracy, const std::string& moduli, const std::string& rest) {
  return "[box]\nsize = [6, 6, 8]\n[flow]\ncapillary_number = 0.1\n[run]\nstrain = 1\n[accuracy]\nradius = 8\nallow_unstable = true\n" + accuracy +
         "\n[[cells]]\nshape = 'sphere'\ncount = 10\nmembrane = { law = 'neo_hookean', " + moduli + " }\n" + rest;
}

}  // namespace

int main(int argc, char** argv) {
  Kokkos::ScopeGuard scope(argc, argv);
  const std::string no_contact = "[contact]\nenabled = false\n", none = "bending = 0, global_area = 0, volume = 0";
  const std::string all = "bending = 0.01, global_area = 1, volume = 1";
  const std::string euler = "vertex_update = 'euler'", averaged = "vertex_update = 'averaged'";
  std::printf("| scene | launches a step | kernels | bytes a node | bytes a vertex | allocations, copies, waits a step |\n|---|---|---|---|---|---|\n");
  report("fluid, float, periodic", "[box]\nsize = [6, 6, 6]\nwalls = false\n[flow]\nkind = 'rest'\n[accuracy]\nradius = 8\n[run]\nsteps = 10\n");
  report("fluid, float, walls", "[box]\nsize = [6, 6, 6]\n[accuracy]\nradius = 8\n[run]\nstrain = 1\n");
  report("fluid, double, walls", "[box]\nsize = [6, 6, 6]\n[accuracy]\nradius = 8\nprecision = 'double'\n[run]\nstrain = 1\n");
  report("capsules with the least: neo-Hookean, euler, no contact", capsules(euler, none, no_contact));
  report("the same with bending, area, volume", capsules(euler, all, no_contact));
  report("the same, averaged (the default)", capsules(averaged, all, no_contact));
  report("the same, contact", capsules(averaged, all, ""));
  report("the same, fluid in double", capsules(averaged + "\nprecision = 'double'", all, ""));
  report("the same, chebyshev", capsules("vertex_update = 'chebyshev'", all, ""));
}
