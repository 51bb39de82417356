// Seconds in every kernel, by Kokkos' profiling callbacks, summed over the operators of a step.
#pragma once
#include <array>
#include <functional>
#include <map>
#include <string>

#include "perf/report.hpp"

namespace corpuscle::perf {

/// Operators of a step in its order; "other" is a kernel that belongs to none, "outside" the time between kernels: launches and host code.
inline const std::array<std::string, 9> operators{"membrane", "contact", "spread", "collide", "halo", "interpolate", "motion", "other", "outside"};

/// The operator that a kernel belongs to, by its label. Warns of kernels of this project that belong to none.
std::string operator_of(const std::string& label);

struct StepTimes {
  double step = 0;                      ///< seconds of a step
  std::map<std::string, double> parts;  ///< seconds of a step in each operator, adding up to `step`
};

/// The fastest of `repeats` blocks of `steps` steps. The callbacks synchronise devices after each kernel.
StepTimes step_times(const std::function<void()>& step, int repeats, int steps);

/// Adds the milliseconds of each operator to a row: "membrane_ms", ...
void add_parts(Json& row, const StepTimes& times);
/// The metrics of these columns.
std::vector<Metric> part_metrics();

}  // namespace corpuscle::perf
