#include "physics/analysis/record.hpp"

#include "physics/statistics/estimate.hpp"

namespace corpuscle::analysis {

Eigen::MatrixXd CellSeries::component(CellQuantity quantity, int component, Eigen::Index first, Eigen::Index times) const {
  Eigen::MatrixXd result = Eigen::MatrixXd::Constant(times, cells(), statistics::not_a_number);
  const Eigen::Index stride = components_of(quantity);
  visit(quantity, first, [&](Eigen::Index time, std::span<const double> values) {
    if (time - first >= times) return;
    for (Eigen::Index cell = 0; cell < cells(); ++cell) result(time - first, cell) = values[static_cast<std::size_t>(cell * stride + component)];
  });
  return result;
}

Eigen::Index RunRecord::cell_count() const {
  Eigen::Index count = 0;
  for (const auto& type : types) count += type.count;
  return count;
}

double RunRecord::mean_effective_radius() const {
  double sum = 0;
  for (const auto& type : types) sum += type.effective_radius * static_cast<double>(type.count);
  return cell_count() > 0 ? sum / static_cast<double>(cell_count()) : statistics::not_a_number;
}

RunRecord referred_to(double factor, RunRecord record) {
  for (double* value : {&record.capillary_number, &record.shear_rate, &record.rate_factor, &record.interval, &record.strain}) *value *= factor;
  for (double& value : record.relative_viscosity) value = 1 + (value - 1) / factor;  // of the particle stress beyond eta_0
  for (double& value : record.wall_relative_viscosity) value /= factor;              // of the whole stress
  return record;
}

}  // namespace corpuscle::analysis
