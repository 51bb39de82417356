// Bytes that suspensions allocate, against the formula that `corpuscle plan` prints and the growth of the process.
#include <malloc.h>

#include <fstream>

#include "perf/red_cells.hpp"
#include "perf/report.hpp"
#include "physics/suspension.hpp"
#include "physics/memory.hpp"

using namespace corpuscle;
using namespace corpuscle::perf;

namespace {

/// A line of /proc/self/status in bytes: VmRSS is present memory, VmHWM its peak.
double memory_of_process(const std::string& wanted) {
  std::ifstream file("/proc/self/status");
  std::string key;
  for (double kibibytes = 0; file >> key; file.ignore(1000, '\n'))
    if (key == wanted + ":" && file >> kibibytes) return kibibytes * 1024;
  return 0;
}
/// Gives freed memory back and lets the peak start anew (proc(5), clear_refs). False where the system doesn't allow it.
bool forget_peak() {
  malloc_trim(0);
  std::ofstream file("/proc/self/clear_refs");
  file << "5" << std::flush;
  return bool(file);
}

void measure(Section& section, const std::string& name, const SuspensionCase& c) {
  const bool peak_known = forget_peak();
  const double before = memory_of_process("VmRSS");
  const auto suspension = make_suspension(c.problem, c.lattice, c.types, c.positions);
  suspension->step(), suspension->step();
  const double bytes = double(suspension->bytes()), nodes = c.nodes();
  const double vertices = c.types.empty() ? 0 : c.vertices();
  Json row = {{"nodes", c.lattice.nodes},
              {"vertices", std::int64_t(vertices)},
              {"MiB", bytes / 1048576},
              {"predicted_MiB", double(predict_memory(c.problem, c.lattice).suspension()) / 1048576},
              {"bytes_per_node", bytes / nodes}};
  if (peak_known) row["peak_MiB"] = (memory_of_process("VmHWM") - before) / 1048576;
  if (vertices > 0) {
    // The same box with a force and velocity field but without vertices: what is left belongs to the vertices.
    LatticeParameters none = c.lattice;
    for (auto& type : none.cells) type.count = 0;
    Problem no_contact = c.problem;
    no_contact.contact.enabled = false;
    const double fields = double(predict_memory(no_contact, none).suspension());
    row["bytes_per_node"] = fields / nodes;
    row["bytes_per_vertex"] = (bytes - fields) / vertices;
  }
  section.row(name, row);
}

SuspensionCase without_cells(const SuspensionSettings& settings) {
  SuspensionCase c = suspension_case(settings);
  c.problem.cells.clear();
  c.problem.flow.capillary_number.reset();
  c.lattice = to_lattice(c.problem);
  c.types.clear();
  return c;
}

}  // namespace

int main(int argc, char** argv) {
  Section section(argc, argv, "memory", "Allocated by the suspension, predicted by the formula of `corpuscle plan`, and growth of the process' peak.",
                  {{"MiB", "lower"}, {"predicted_MiB", "lower"}, {"peak_MiB", "lower"}});
  Kokkos::ScopeGuard scope(argc, argv);
  SuspensionSettings s = usual_settings(section.effort().quick);
  section.note("bytes_per_node of suspensions: fields of the formula; bytes_per_vertex: the rest of what was allocated, lists of contacts and bins included.");
  measure(section, "fluid alone, float", without_cells(s));
  s.phi = 0.2;
  measure(section, "phi 0.2, packed, contact, float", packed_suspension(s, {2, 2, 1}));
  s.phi = 0.36;
  const SuspensionCase packed = packed_suspension(s, {2, 2, 1});
  measure(section, "phi 0.36, packed, contact, float", packed);
  s.precision = Precision::double_precision;
  measure(section, "fluid alone, double", without_cells(s));
  measure(section, "phi 0.36, packed, contact, double", with_positions_of(packed, s));
  return section.finish();
}
