#include "app/outputs.hpp"

#include <fmt/format.h>

#include <Kokkos_Profiling_ScopedRegion.hpp>

#include "app/machine.hpp"
#include "core/error.hpp"
#include "core/version.hpp"
#include "io/scene.hpp"

namespace corpuscle::app {
namespace {

namespace fs = std::filesystem;

VtkDomain domain_of(const Problem& problem, const LatticeParameters& lattice) {
  VtkDomain domain;
  for (int k = 0; k < 3; ++k) domain.size[k] = lattice.nodes[k];
  domain.periodic[2] = !problem.box.walls;
  domain.radius = lattice.radius;
  domain.at_rest = problem.flow.kind == FlowKind::rest;
  return domain;
}

std::vector<VtkCellType> surfaces_of(const std::vector<CellType>& types) {
  std::vector<VtkCellType> surfaces;
  for (const auto& t : types) surfaces.push_back({t.name, t.reference.faces, t.vertices(), t.count});
  return surfaces;
}

bool writes_cells(const LatticeParameters& lattice, const std::vector<CellType>& types) { return lattice.snapshot_every > 0 && !types.empty(); }
bool writes_fluid(const Problem& problem, const LatticeParameters& lattice) { return lattice.snapshot_every > 0 && problem.output.fluid; }

/// A file that was changed from outside (or lost with its disk) must not be continued with a gap.
void check_count(const fs::path& path, std::size_t found, std::int64_t step, std::int64_t every, const char* what) {
  const auto expected = static_cast<std::size_t>((step + every - 1) / every);
  if (found != expected)
    throw OutputError(fmt::format("{} holds {} {} from before step {} of the checkpoint, but {} were written: "
                                  "it was changed or damaged since; restore it, or start again with corpuscle run",
                                  path.string(), found, what, step, expected));
}

}  // namespace

Outputs::Outputs(const fs::path& directory, const Problem& problem, const LatticeParameters& lattice, const std::vector<CellType>& types)
    : file_(directory / "run.h5",
            RunMetadata{to_toml(problem), version_string(), git_revision(), cpu_model(), cpu_cores(), operating_system(), kokkos_configuration()}, lattice,
            RunFileOptions{.trajectories = problem.output.trajectories && !types.empty()}) {
  const VtkDomain domain = domain_of(problem, lattice);
  if (writes_cells(lattice, types)) cells_.emplace(directory / "cells.vtkhdf", surfaces_of(types), domain);
  if (writes_fluid(problem, lattice)) fluid_.emplace(directory / "fluid.vtkhdf", lattice.nodes, domain);
}

Outputs Outputs::resume(const fs::path& directory, const Problem& problem, const LatticeParameters& lattice, const std::vector<CellType>& types,
                        std::int64_t step) {
  const std::int64_t last = step - 1;
  const double strain = lattice.shear_rate * double(last);
  const VtkDomain domain = domain_of(problem, lattice);
  Outputs outputs(RunFile::resume(directory / "run.h5", last));
  check_count(directory / "run.h5", outputs.file_.samples(), step, lattice.series_every, "samples");
  if (writes_cells(lattice, types)) {
    outputs.cells_.emplace(VtkHdfPolyData::resume(directory / "cells.vtkhdf", surfaces_of(types), domain, last, strain));
    check_count(directory / "cells.vtkhdf", outputs.cells_->snapshots(), step, lattice.snapshot_every, "snapshots");
  }
  if (writes_fluid(problem, lattice)) {
    outputs.fluid_.emplace(VtkHdfImage::resume(directory / "fluid.vtkhdf", lattice.nodes, domain, last, strain));
    check_count(directory / "fluid.vtkhdf", outputs.fluid_->snapshots(), step, lattice.snapshot_every, "snapshots");
  }
  return outputs;
}

void Outputs::series(const Sample& sample) {
  const Kokkos::Profiling::ScopedRegion region("write_series");
  file_.append(sample);
}

void Outputs::snapshot(const Suspension& suspension) {
  if (!cells_ && !fluid_) return;
  const Kokkos::Profiling::ScopedRegion region("write_snapshot");
  const Snapshot s = suspension.snapshot(fluid_.has_value());
  if (cells_) cells_->append(s);
  if (fluid_) fluid_->append(s);
}

void Outputs::flush() {
  const Kokkos::Profiling::ScopedRegion region("write_series");
  file_.flush();
}

}  // namespace corpuscle::app
