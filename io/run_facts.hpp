// What run.h5 says of a run, to compare its other files with.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "physics/problem.hpp"

namespace corpuscle {

/// Empty optionals: it could not be read.
struct RunFacts {
  std::optional<std::string> scene;
  std::optional<bool> walls;
  FlowKind flow = FlowKind::shear;
  std::vector<std::int64_t> steps;  ///< of the series
  std::vector<double> strain, relative_viscosity, volume_drift_max;
  std::vector<std::string> type_names;
  std::vector<std::int64_t> type_counts, type_vertices;
  std::vector<double> nodes;
  double shear_rate = 0;
  std::int64_t last_step = 0, series_every = 0, snapshot_every = 0;
  bool readable = false;

  /// Of all cells.
  std::int64_t vertices() const {
    std::int64_t sum = 0;
    for (std::size_t i = 0; i < type_counts.size(); ++i) sum += type_counts[i] * type_vertices[i];
    return sum;
  }
};

}  // namespace corpuscle
