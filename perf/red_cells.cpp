#include "perf/red_cells.hpp"

#include <algorithm>
#include <cmath>

#include "core/random.hpp"
#include "physics/packing.hpp"
#include "physics/placement.hpp"

namespace corpuscle::perf {

namespace {

SuspensionCase with_count(const SuspensionSettings& settings, int count, bool overlapping = false) {
  SuspensionCase c;
  Problem& p = c.problem;
  for (int k = 0; k < 3; ++k) p.box.size[k] = settings.nodes[k] / settings.radius;
  p.box.walls = settings.walls;
  if (settings.walls) {
    p.flow.capillary_number = 0.1;
  } else {
    p.flow.kind = FlowKind::rest;
    p.run.steps = 100;
  }
  CellSpec cell;
  cell.name = "red_cell";
  cell.count = count;
  p.cells = {cell};
  p.accuracy.radius = settings.radius;
  p.accuracy.subdivision = settings.subdivision;
  p.accuracy.delta_kernel = settings.points;
  p.accuracy.precision = settings.precision;
  p.accuracy.membrane_precision = settings.membrane;
  p.accuracy.allow_unstable = true;  // a benchmark takes a few steps
  if (overlapping) {
    p.contact.enabled = false;
    p.accuracy.shell_thickness = 0;  // no refusal of what could not be packed
  }
  c.lattice = to_lattice(p);
  c.types = make_cell_types(p, c.lattice);
  return c;
}

int count_for(const SuspensionSettings& settings) {
  const double volume = mesh_volume(red_cell_mesh(settings.radius, settings.subdivision));
  return std::max(1, int(std::lround(settings.phi * settings.nodes[0] * settings.nodes[1] * settings.nodes[2] / volume)));
}

}  // namespace

SuspensionSettings usual_settings(bool quick) {
  SuspensionSettings s;
  if (quick) {
    s.nodes = {32, 32, 32};
    s.radius = s.subdivision = 4;
  }
  return s;
}

SuspensionCase suspension_case(const SuspensionSettings& settings) { return with_count(settings, count_for(settings)); }

SuspensionCase random_suspension(const SuspensionSettings& settings, double z_from, double z_to) {
  SuspensionCase c = with_count(settings, count_for(settings), true);
  RandomStream random(1);
  const double margin = settings.walls ? settings.radius : 0, height = settings.nodes[2];
  for (int i = 0; i < c.cells(); ++i) {
    const double x = random.uniform(0, settings.nodes[0]), y = random.uniform(0, settings.nodes[1]);
    const double z = random.uniform(std::max(margin, z_from * height), std::max(margin, std::min(height - margin, z_to * height)));
    const auto placed = place_mesh(c.types[0].reference, Vector3(x, y, z), random_rotation(random));
    c.positions.insert(c.positions.end(), placed.begin(), placed.end());
  }
  return c;
}

SuspensionCase packed_suspension(const SuspensionSettings& settings, std::array<int, 3> copies) {
  SuspensionSettings block_settings = settings;
  for (int k = 0; k < 3; ++k) block_settings.nodes[k] = settings.nodes[k] / copies[k];
  const SuspensionCase block = suspension_case(block_settings);
  const auto places = place_cells(block.problem, block.lattice, block.types);
  SuspensionCase c = with_count(settings, block.cells() * copies[0] * copies[1] * copies[2]);
  for (int k = 0; k < copies[2]; ++k)
    for (int j = 0; j < copies[1]; ++j)
      for (int i = 0; i < copies[0]; ++i) {
        const double shift[3] = {double(i * block_settings.nodes[0]), double(j * block_settings.nodes[1]), double(k * block_settings.nodes[2])};
        for (std::size_t n = 0; n < places.size(); ++n) c.positions.push_back(places[n] + shift[n % 3]);
      }
  return c;
}

SuspensionCase with_positions_of(const SuspensionCase& packed, const SuspensionSettings& settings) {
  SuspensionCase c = with_count(settings, packed.cells());
  c.positions = packed.positions;
  return c;
}

}  // namespace corpuscle::perf
