#include "app/outputs.hpp"

#include <fmt/format.h>

#include <Kokkos_Profiling_ScopedRegion.hpp>

#include "app/machine.hpp"
#include "core/error.hpp"
#include "core/version.hpp"
#include "io/checkpoint.hpp"
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

/// A file that was changed from outside (or lost with its disk) must not be continued with a gap.
void check_count(const fs::path& path, std::size_t found, std::int64_t step, std::int64_t every, const char* what) {
  const auto expected = static_cast<std::size_t>(written_before(step, every));
  if (found != expected)
    throw OutputError(fmt::format("{} holds {} {} from before step {} of the checkpoint, but {} were written: "
                                  "it was changed or damaged since; restore it, or start again with corpuscle run",
                                  path.string(), found, what, step, expected));
}

}  // namespace

Outputs::Outputs(RunFile&& file, const fs::path& directory, const Problem& problem, const LatticeParameters& lattice, const std::vector<CellType>& types)
    : file_(std::move(file)),
      directory_(directory),
      nodes_(lattice.nodes),
      domain_(domain_of(problem, lattice)),
      surfaces_(surfaces_of(types)),
      with_fluid_(problem.output.fluid) {}

Outputs::Outputs(const fs::path& directory, const Problem& problem, const LatticeParameters& lattice, const std::vector<CellType>& types)
    : Outputs(RunFile(directory / "run.h5",
                      RunMetadata{to_toml(problem), version_string(), git_revision(), cpu_model(), cpu_cores(), operating_system(), kokkos_configuration()},
                      lattice, RunFileOptions{.trajectories = problem.output.trajectories && !types.empty()}),
              directory, problem, lattice, types) {
  if (lattice.snapshot_every == 0) return;
  if (!types.empty()) cells_.emplace(directory / "cells.vtkhdf", surfaces_, domain_);
  if (with_fluid_) fluid_.emplace(directory / "fluid.vtkhdf", nodes_, domain_);
}

Outputs Outputs::resume(const fs::path& directory, const Problem& problem, const LatticeParameters& lattice, const std::vector<CellType>& types,
                        std::int64_t step) {
  const std::int64_t last = step - 1;
  const double strain = lattice.shear_rate * double(last);
  Outputs o(RunFile::resume(directory / "run.h5", last), directory, problem, lattice, types);
  check_count(directory / "run.h5", o.file_.samples(), step, lattice.series_every, "samples");
  if (lattice.snapshot_every == 0) return o;
  if (!types.empty()) {
    o.cells_.emplace(VtkHdfPolyData::resume(directory / "cells.vtkhdf", o.surfaces_, o.domain_, last, strain));
    check_count(directory / "cells.vtkhdf", o.cells_->snapshots(), step, lattice.snapshot_every, "snapshots");
  }
  if (o.with_fluid_) {
    o.fluid_.emplace(VtkHdfImage::resume(directory / "fluid.vtkhdf", o.nodes_, o.domain_, last, strain));
    check_count(directory / "fluid.vtkhdf", o.fluid_->snapshots(), step, lattice.snapshot_every, "snapshots");
  }
  return o;
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

std::string Outputs::broken_state(const Suspension& suspension) const {
  const bool fluid = with_fluid_ || surfaces_.empty();
  std::string files;
  try {
    const Snapshot s = suspension.snapshot(fluid);
    if (!surfaces_.empty()) VtkHdfPolyData(directory_ / "broken.vtkhdf", surfaces_, domain_).append(s), files = "broken.vtkhdf";
    if (fluid) VtkHdfImage(directory_ / "broken_fluid.vtkhdf", nodes_, domain_).append(s), files += files.empty() ? "broken_fluid.vtkhdf" : " and broken_fluid.vtkhdf";
  } catch (const OutputError& failed) {
    return fmt::format(" The state could not be saved: {}.", failed.what());
  }
  return fmt::format(" Look at the state in {}.", files);
}

void Outputs::flush() {
  const Kokkos::Profiling::ScopedRegion region("write_series");
  file_.flush();
}

}  // namespace corpuscle::app
