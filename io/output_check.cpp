#include "io/output_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "core/error.hpp"
#include "io/checkpoint_check.hpp"
#include "io/hdf5.hpp"
#include "io/hdf5_transaction.hpp"
#include "io/lock.hpp"
#include "io/run_facts.hpp"
#include "io/run_file.hpp"
#include "io/scene.hpp"
#include "io/summary_check.hpp"

namespace corpuscle {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t piece_values = std::size_t{1} << 20;  // that are read at a time

class Checker {
 public:
  Checker(const fs::path& directory, const std::set<std::string>& skip, const std::function<void(const std::string&)>& reading)
      : directory_(directory), skip_(skip), reading_(reading) {}

  OutputCheck run() {
    const std::string holder = lock_holder(directory_);
    running_ = !holder.empty();
    if (running_) note(fmt::format("a run is writing here ({}): what follows is how far it is", holder));
    examine("run.h5", true, [&](const fs::path& path) { run_file(path); });
    examine("cells.vtkhdf", false, [&](const fs::path& path) { snapshots(path, "cells.vtkhdf"); });
    examine("fluid.vtkhdf", false, [&](const fs::path& path) { snapshots(path, "fluid.vtkhdf"); });
    compare_snapshots();
    examine("packing.h5", false, [&](const fs::path& path) { packing(path); });
    examine("scene.toml", true, [&](const fs::path& path) { scene(path); });
    checkpoints();
    try {
      if (!skip_.contains("summary.json") && check_summary(directory_ / "summary.json", run_, running_, reading_, out_)) out_.is_output = true;
    } catch (const std::exception& error) {
      problem("summary.json", error.what(), "its means can be computed again from run.h5");
    }
    std::error_code ignored;
    if (fs::exists(directory_ / ".replaced", ignored))
      note("the folder .replaced holds the results that an interrupted `--overwrite` set aside; move them back, or remove it");
    if (!out_.is_output) out_.problems.clear();
    return std::move(out_);
  }

 private:
  void problem(const std::string& file, const std::string& what, const std::string& advice) { out_.problems.push_back({file, what, advice}); }
  void note(const std::string& text) { out_.notes.push_back(text); }
  void progress(const std::string& file) const {
    if (reading_) reading_(file);
  }

  /// Runs the check of one file; whatever goes wrong in it is a problem of that file.
  template <class Check>
  void examine(const std::string& name, bool required, const Check& check) {
    std::error_code ignored;
    const fs::path path = directory_ / name;
    if (!fs::exists(path, ignored)) {
      if (required) problem(name, "is missing", "it can't be restored; the other files can still be used");
      return;
    }
    out_.is_output = true;
    if (skip_.contains(name)) return;
    progress(name);
    if (fs::exists(hdf5::journal_path(path), ignored))
      problem(name, "a write was cut off by a kill", "corpuscle check --recover finishes it, or takes it back; so does corpuscle resume");
    try {
      check(path);
    } catch (const std::exception& error) {
      std::string text = error.what();
      if (const std::string prefix = path.string() + ": "; text.starts_with(prefix)) text.erase(0, prefix.size());
      problem(name, text, "the file is damaged there; what is not named here could be read");
    }
  }

  void run_file(const fs::path& path) {
    const std::string name = "run.h5";
    const auto file = hdf5::File::open_for_reading(path);
    if (const auto format = file.string_attribute("/", "format"); format != "corpuscle run 1") {
      problem(name, "has the format '" + format.substr(0, 60) + "' instead of 'corpuscle run 1'", "use the version of corpuscle that wrote it");
      return;
    }
    run_.scene = file.string_attribute("/", "scene");
    try {
      const Problem problem = parse_scene(*run_.scene, "the scene in run.h5");
      run_.walls = problem.box.walls;
      run_.flow = problem.flow.kind;
    } catch (const InputError& error) {
      const std::string what = error.what();  // a mesh or packing elsewhere may have been moved since: no fault of this file
      if (what.find("there is no such file") != std::string::npos) note(what);
      else problem(name, what, "the file was changed or damaged");
    }
    const auto integer = [&](const char* attribute) {
      const double value = file.number_attribute("/lattice", attribute);
      if (!(value >= 0 && value < 9e15)) throw OutputError(fmt::format("/lattice has {} = {}", attribute, value));
      return static_cast<std::int64_t>(value);
    };
    run_.nodes = file.numbers_attribute("/lattice", "nodes");
    run_.shear_rate = file.number_attribute("/lattice", "shear_rate");
    run_.last_step = integer("steps");
    run_.series_every = std::max<std::int64_t>(1, integer("series_every"));
    run_.snapshot_every = integer("snapshot_every");
    for (std::size_t i = 0; file.exists(fmt::format("/lattice/cell_types/{}", i)); ++i) {
      const auto group = fmt::format("/lattice/cell_types/{}", i);
      run_.type_names.push_back(file.string_attribute(group, "name"));
      run_.type_counts.push_back(static_cast<std::int64_t>(std::clamp(file.number_attribute(group, "count"), 0.0, 1e15)));
      run_.type_vertices.push_back(static_cast<std::int64_t>(std::clamp(file.number_attribute(group, "vertices"), 0.0, 1e15)));
    }
    run_.readable = true;
    series(file);
  }

  void series(const hdf5::File& file) {
    const std::string name = "run.h5";
    const bool trajectories = file.exists("/cells");
    std::size_t shortest = SIZE_MAX, longest = 0;
    for (const auto& dataset : run_file_rows(trajectories)) {
      if (!file.exists(dataset)) {
        problem(name, dataset + " is missing", "the other datasets can still be used");
        continue;
      }
      const std::size_t rows = rows_of(file, dataset);
      shortest = std::min(shortest, rows);
      longest = std::max(longest, rows);
    }
    if (longest == 0 || shortest == SIZE_MAX) {
      if (!running_) problem(name, "holds no sample", "the run ended before it wrote any: run it again");
      return;
    }
    if (shortest != longest)
      problem(name, fmt::format("has series of {} to {} rows", shortest, longest),
          fmt::format("the run was stopped while writing; the first {} samples are complete", shortest));
    run_.steps = file.read_rows<std::int64_t>("/series/step", 0, shortest).values;
    times(shortest);
    for (const auto& dataset : run_file_rows(trajectories))
      if (file.exists(dataset) && dataset != "/series/step") finite(file, name, dataset, shortest);
    const auto column = [&](const char* dataset) { return file.exists(dataset) ? file.read_rows<double>(dataset, 0, shortest).values : std::vector<double>{}; };
    run_.strain = column("/series/strain");
    run_.relative_viscosity = column("/series/relative_viscosity");
    run_.volume_drift_max = column("/series/volume_drift_max");
    for (std::size_t i = 0; i < run_.strain.size(); ++i) {
      const double expected = run_.shear_rate * static_cast<double>(run_.steps[i]);
      if (std::abs(run_.strain[i] - expected) <= 1e-9 * std::max(1.0, std::abs(expected))) continue;
      problem(name, fmt::format("/series/strain at step {} is {:.9g} instead of shear rate x step = {:.9g}", run_.steps[i], run_.strain[i], expected),
          "the file was changed or damaged");
      break;
    }
    if (trajectories) cells(file, shortest);
    out_.samples = static_cast<std::int64_t>(shortest);
    if (shortest > 0) out_.last_step = run_.steps.back();
  }

  static std::size_t rows_of(const hdf5::File& file, const std::string& dataset) {
    const auto shape = file.shape(dataset);
    if (shape.empty()) throw OutputError(dataset + " is a single number instead of a series");
    return shape[0];
  }

  /// Strictly ascending, at the cadence; only the last may come early.
  void times(std::size_t rows) {
    for (std::size_t i = 0; i < rows; ++i) {
      const std::int64_t step = run_.steps[i], before = i > 0 ? run_.steps[i - 1] : -run_.series_every;
      const std::int64_t expected = before + run_.series_every;
      if (step == expected || (i > 0 && i + 1 == rows && step > before && step < expected)) continue;
      problem("run.h5", fmt::format("sample {} is of step {}, but after step {} comes step {}", i, step, before, expected),
              step > expected ? "samples are missing there; the others can be used" : "samples are doubled or damaged there; use those before");
      return;
    }
  }

  bool may_be_nan(const std::string& dataset) const {
    const bool rest = run_.shear_rate == 0, walls = run_.walls.value_or(false);
    const std::string leaf = dataset.substr(dataset.rfind('/') + 1);
    if (leaf == "wall_shear_stress") return !walls;
    if (leaf == "wall_relative_viscosity") return !walls || run_.flow != FlowKind::shear;
    if (leaf == "bulk_relative_viscosity") return run_.flow != FlowKind::shear;
    if (leaf == "mean_deformation" || leaf == "volume_drift_max" || leaf == "area_drift_max") return run_.type_names.empty();
    const bool relative = leaf.ends_with("relative_viscosity") || leaf.starts_with("normal_stress") || leaf == "particle_pressure";
    return relative && rest;
  }

  /// No NaN and no infinity in the first rows of a dataset of numbers.
  void finite(const hdf5::File& file, const std::string& name, const std::string& dataset, std::size_t rows) {
    const auto shape = file.shape(dataset);
    double row_values = 1;
    for (std::size_t k = 1; k < shape.size(); ++k) row_values *= static_cast<double>(shape[k]);
    const bool nan_allowed = may_be_nan(dataset);
    const auto step = static_cast<std::size_t>(std::max(1.0, static_cast<double>(piece_values) / std::max(1.0, row_values)));
    for (std::size_t first = 0; first < rows; first += step) {
      progress(name);
      const auto piece = file.read_rows<double>(dataset, first, std::min(step, rows - first)).values;
      const auto bad = std::find_if(piece.begin(), piece.end(), [&](double x) { return !(std::isfinite(x) || (nan_allowed && std::isnan(x))); });
      if (bad == piece.end()) continue;
      const auto row = first + static_cast<std::size_t>(static_cast<double>(bad - piece.begin()) / row_values);
      problem(name, fmt::format("{} holds {} in row {}", dataset, *bad, row), fmt::format("rows 0 to {} of it are good", static_cast<long long>(row) - 1));
      return;
    }
  }

  void cells(const hdf5::File& file, std::size_t rows) {
    const std::string name = "run.h5";
    const auto types = file.read<std::int32_t>("/cells/type").values;
    if (file.read_strings("/cells/type_names") != run_.type_names) problem(name, "/cells/type_names differs from the names in /lattice/cell_types",
        "the file was changed or damaged");
    for (std::size_t i = 0; i < run_.type_counts.size(); ++i) {
      const auto found = std::count(types.begin(), types.end(), static_cast<std::int32_t>(i));
      if (found != run_.type_counts[i])
        problem(name, fmt::format("/cells/type lists {} cells of type '{}' instead of {}", found, run_.type_names[i], run_.type_counts[i]),
            "the file was changed or damaged");
    }
    for (const auto& dataset : run_file_rows(true)) {
      if (!dataset.starts_with("/cells/") || !file.exists(dataset)) continue;
      const auto shape = file.shape(dataset);
      if (shape.size() < 2 || shape[1] != types.size()) problem(name, dataset + " is not about the cells of /cells/type", "the file was changed or damaged");
    }
    if (rows == 0) return;
    for (const char* dataset : {"/cells/volume", "/cells/area"}) {
      if (!file.exists(dataset)) continue;
      const auto last = file.read_rows<double>(dataset, rows - 1, 1).values;
      const auto gone = std::find_if(last.begin(), last.end(), [](double x) { return !(x > 0); });
      if (gone != last.end()) problem(name, fmt::format("{} of cell {} is {} in the last sample", dataset, gone - last.begin(), *gone),
          "the run broke: look for the step where it becomes so");
    }
  }

  /// cells.vtkhdf and fluid.vtkhdf have the same steps, and data of their own.
  void snapshots(const fs::path& path, const std::string& name) {
    const auto file = hdf5::File::open_for_reading(path);
    const double count = file.number_attribute("/VTKHDF/Steps", "NSteps");
    if (!(count >= 0 && count < 1e12)) throw OutputError(fmt::format("NSteps is {}", count));
    const auto steps = static_cast<std::size_t>(count);
    const std::size_t written = rows_of(file, "/VTKHDF/Steps/Values");
    if (written < steps) problem(name, fmt::format("announces {} snapshots, but has the times of {}", steps, written), "the file was changed or damaged");
    if (written > steps) note(fmt::format("{}: a snapshot was being written when the run stopped; readers ignore it", name));
    auto times = file.read_rows<double>("/VTKHDF/Steps/Values", 0, std::min(written, steps)).values;
    for (std::size_t i = 0; i < times.size(); ++i) {
      const double before = i > 0 ? times[i - 1] : -1;
      const double every = static_cast<double>(run_.snapshot_every) * (run_.shear_rate == 0 ? 1 : run_.shear_rate);
      if (!std::isfinite(times[i]) || times[i] <= before) problem(name, fmt::format("snapshot {} has the time {:.9g} after {:.9g}", i, times[i], before),
          fmt::format("the first {} snapshots can be used", i));
      else if (run_.readable && every > 0 && times[i] > (static_cast<double>(i) + 1e-6) * every)
        problem(name, fmt::format("snapshot {} is of {:.9g}, but should be of {:.9g}", i, times[i], static_cast<double>(i) * every),
            "snapshots are missing there; the others can be used");
      else continue;
      break;
    }
    const bool fluid = name == "fluid.vtkhdf";
    if (fluid) {
      const auto shape = file.shape("/VTKHDF/PointData/velocity");
      if (run_.readable && run_.nodes.size() == 3)
        if (shape.size() != 5 || double(shape[1]) != run_.nodes[2] || double(shape[2]) != run_.nodes[1] || double(shape[3]) != run_.nodes[0])
          problem(name, "the grid differs from the box of run.h5", "the file belongs to another run");
      points(file, name, "/VTKHDF/PointData/velocity", steps);
      fluid_times_ = std::move(times);
    } else {
      const std::int64_t per_step = run_.vertices();
      const auto stored = file.read<std::int64_t>("/VTKHDF/NumberOfPoints").values;
      if (stored.size() != 1 || stored[0] < 0 || (run_.readable && stored[0] != per_step)) {
        problem(name, fmt::format("has {} points a snapshot instead of {}", stored.empty() ? 0 : stored[0], per_step), "the file belongs to another run");
        return;
      }
      const auto rows = steps * static_cast<std::size_t>(stored[0]);
      for (const char* data : {"/VTKHDF/Points", "/VTKHDF/PointData/velocity", "/VTKHDF/PointData/deformation"}) points(file, name, data, rows);
      for (const std::int32_t corner : file.read<std::int32_t>("/VTKHDF/Polygons/Connectivity").values)
        if (corner < 0 || corner >= stored[0]) {
          problem(name, fmt::format("a face names point {} of {}", corner, stored[0]), "the file is damaged");
          break;
        }
      cell_times_ = std::move(times);
    }
    out_.snapshots = std::max(out_.snapshots, static_cast<std::int64_t>(steps));
  }

  void points(const hdf5::File& file, const std::string& name, const std::string& dataset, std::size_t rows) {
    const std::size_t written = rows_of(file, dataset);
    if (written < rows) problem(name, fmt::format("{} has {} rows instead of {}", dataset, written, rows),
        "the file was changed or damaged; earlier snapshots can be used");
    finite(file, name, dataset, std::min(rows, written));
  }

  void compare_snapshots() {
    if (cell_times_.empty() || fluid_times_.empty()) return;
    const std::size_t both = std::min(cell_times_.size(), fluid_times_.size());
    if (!std::equal(cell_times_.begin(), cell_times_.begin() + static_cast<std::ptrdiff_t>(both), fluid_times_.begin()))
      problem("fluid.vtkhdf", "its snapshots are of other times than those of cells.vtkhdf", "the files belong to different runs");
    else if (cell_times_.size() != fluid_times_.size())
      problem("fluid.vtkhdf", fmt::format("has {} snapshots, cells.vtkhdf has {}", fluid_times_.size(), cell_times_.size()),
          fmt::format("the run was stopped between both; the first {} belong together", both));
  }

  void packing(const fs::path& path) {
    const auto file = hdf5::File::open_for_reading(path);
    const auto positions = file.read<double>("/positions");
    if (!std::all_of(positions.values.begin(), positions.values.end(), [](double x) { return std::isfinite(x); }))
      problem("packing.h5", "a position is not a finite number", "it can't be used as run.packing; pack anew");
    if (run_.readable && positions.values.size() != 3 * static_cast<std::size_t>(run_.vertices()))
      problem("packing.h5", fmt::format("has {} coordinates instead of {}", positions.values.size(), 3 * run_.vertices()), "it belongs to another run");
  }

  void checkpoints() {
    // Of a run that goes on the checkpoints may be newer than what was read of the series.
    out_.resumes_at = check_checkpoints(directory_, run_, !running_, skip_, reading_, out_.problems);
    if (out_.resumes_at >= 0) out_.is_output = true;
    if (out_.resumes_at >= 0 && !running_) note(fmt::format("corpuscle resume would go on at step {} of {}", out_.resumes_at, run_.last_step));
  }

  void scene(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::string text(std::size_t{4} << 20, '\0');
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(file.gcount()));
    if (run_.scene && text != *run_.scene) problem("scene.toml", "differs from the scene stored in run.h5", "that in run.h5 is what was run");
  }

  fs::path directory_;
  const std::set<std::string>& skip_;
  const std::function<void(const std::string&)>& reading_;
  OutputCheck out_;
  RunFacts run_;
  std::vector<double> cell_times_, fluid_times_;
  bool running_ = false;
};

}  // namespace

OutputCheck check_output_files(const fs::path& directory, const std::set<std::string>& skip, const std::function<void(const std::string&)>& reading) {
  return Checker(directory, skip, reading).run();
}

}  // namespace corpuscle
