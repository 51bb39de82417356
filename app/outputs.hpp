// The files that grow while a run goes on.
#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/run_file.hpp"
#include "io/vtkhdf.hpp"
#include "physics/cells.hpp"
#include "physics/problem.hpp"
#include "physics/suspension.hpp"

namespace corpuscle::app {

/// run.h5, cells.vtkhdf and fluid.vtkhdf, as far as the scene asks for them.
class Outputs {
 public:
  /// New files. Kokkos must be running.
  Outputs(const std::filesystem::path& directory, const Problem& problem, const LatticeParameters& lattice, const std::vector<CellType>& types);
  /// Those of an earlier run as they were before `step`: what was measured at that step or later is cut off.
  /// @throws OutputError when something from before is missing
  static Outputs resume(const std::filesystem::path& directory, const Problem& problem, const LatticeParameters& lattice, const std::vector<CellType>& types,
                        std::int64_t step);

  void series(const Sample& sample);
  void snapshot(const Suspension& suspension);
  /// The state that a guard stopped, for inspection: broken.vtkhdf, broken_fluid.vtkhdf. Returns a sentence for the user.
  std::string broken_state(const Suspension& suspension) const;
  void flush();
  /// States a new length of the run.
  void set_length(const std::string& scene, std::int64_t steps) { file_.set_length(scene, steps); }

 private:
  Outputs(RunFile&& file, const std::filesystem::path& directory, const Problem& problem, const LatticeParameters& lattice, const std::vector<CellType>& types);

  RunFile file_;
  std::filesystem::path directory_;
  std::array<int, 3> nodes_{};
  VtkDomain domain_;
  std::vector<VtkCellType> surfaces_;  ///< none without cells
  bool with_fluid_ = false;
  std::optional<VtkHdfPolyData> cells_;
  std::optional<VtkHdfImage> fluid_;
};

}  // namespace corpuscle::app
