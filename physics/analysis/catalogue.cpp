// The names of all results with their units and what they mean in a line.
#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "physics/analysis/results.hpp"

namespace corpuscle::analysis {
namespace {

const std::vector<NamedEstimate>& all_estimates() {
  using enum Group;
  static const std::vector<NamedEstimate> table{
      {"relative_viscosity", rheology, "1", "1 + particle stress xz of the bulk / (eta_0 imposed shear rate)"},
      {"relative_viscosity_local_rate", rheology, "1", "the same with the shear rate measured in the bulk, which layers at the walls change"},
      {"whole_relative_viscosity", walls, "1", "from the particle stress of the whole box; in channel flow from the flow rate"},
      {"wall_relative_viscosity", walls, "1", "from the shear stress at both walls"},
      {"intrinsic_viscosity", walls, "1", "(whole_relative_viscosity - 1)/phi, phi that of the cells at their nominal size: [eta] of a dilute suspension"},
      {"normal_stress_difference_1", rheology, "eta_0 gamma_dot", "N1 = sigma_xx - sigma_zz of the cells in the bulk"},
      {"normal_stress_difference_2", rheology, "eta_0 gamma_dot", "N2 = sigma_zz - sigma_yy of the cells in the bulk"},
      {"particle_pressure", rheology, "eta_0 gamma_dot", "-(sigma_xx + sigma_yy + sigma_zz)/3 of the cells in the bulk"},
      {"phi_bulk", structure, "1", "effective volume (mesh and shell) of the cells with their centre in the bulk / its volume"},
      {"phi_bulk_geometric", structure, "1", "the same with the volume of the meshes"},
      {"shear_rate_bulk", velocity, "gamma_dot", "slope of the measured velocity profile in the bulk / imposed shear rate"},
      {"velocity_variance_x", velocity, "(gamma_dot r)^2", "variance of the cells' velocities in flow direction about the mean flow, bulk"},
      {"velocity_variance_y", velocity, "(gamma_dot r)^2", "variance of the cells' velocities in vorticity direction, bulk"},
      {"velocity_variance_z", velocity, "(gamma_dot r)^2", "variance of the cells' velocities in gradient direction, bulk"},
      {"velocity_kurtosis_x", velocity, "1", "excess kurtosis of the velocity fluctuations along x: 0 for a Gaussian, positive for wide tails"},
      {"velocity_kurtosis_y", velocity, "1", "excess kurtosis of the velocity fluctuations along y"},
      {"velocity_kurtosis_z", velocity, "1", "excess kurtosis of the velocity fluctuations along z"},
      {"gap_size", gap, "r", "gap l between cells from the balance of dissipation, sum of the variances = [(eta_r - 1)/(1 - phi) - 1] l^2"},
      {"gap_size_lattice", gap, "dx", "the same in lattice spacings"},
      {"relaxation_time_x", velocity, "strain", "integral of the normalised velocity autocorrelation along x"},
      {"relaxation_time_y", velocity, "strain", "integral of the normalised velocity autocorrelation along y"},
      {"relaxation_time_z", velocity, "strain", "integral of the normalised velocity autocorrelation along z"},
      {"diffusivity_msd_y", diffusion, "gamma_dot r^2", "half the slope of the mean square displacement along y"},
      {"diffusivity_msd_z", diffusion, "gamma_dot r^2", "half the slope of the mean square displacement along z"},
      {"diffusivity_vacf_y", velocity, "gamma_dot r^2", "integral of the velocity autocorrelation along y"},
      {"diffusivity_vacf_z", velocity, "gamma_dot r^2", "integral of the velocity autocorrelation along z"},
      {"diffusivity_gamma_y", velocity, "gamma_dot r^2", "integral of the stretched exponential fitted to the autocorrelation along y"},
      {"diffusivity_gamma_z", velocity, "gamma_dot r^2", "integral of the stretched exponential fitted to the autocorrelation along z"},
      {"msd_exponent_y_early", diffusion, "1", "d ln MSD/d ln t along y at lags below 0.3 strains: 2 while cells move straight"},
      {"msd_exponent_z_early", diffusion, "1", "d ln MSD/d ln t along z at lags below 0.3 strains"},
      {"msd_exponent_y_late", diffusion, "1", "d ln MSD/d ln t along y over the last factor of ten of trusted lags: 1 for diffusion"},
      {"msd_exponent_z_late", diffusion, "1", "d ln MSD/d ln t along z over the last factor of ten of trusted lags"},
      {"stress_fluctuation", stress, "1", "RMS of the cells' own xz stresslets about their mean / mean, bulk"},
      {"bulk_stress_fluctuation", rheology, "1", "RMS in time of the bulk's particle stress xz about its mean / mean; falls with the size of the bulk"},
      {"stress_relaxation_time", rheology, "strain", "integrated autocorrelation time of the bulk's particle stress xz"},
      {"stresslet_relaxation_time", stress, "strain", "integrated autocorrelation time of the cells' own xz stresslets"},
      {"deformation", shape, "1", "mean over the cells of D = (L - B)/(L + B) in the shear plane, bulk"},
      {"inclination", shape, "rad", "mean angle of the cells' long axis in the shear plane against +x, bulk"},
      {"order_parameter", shape, "1", "largest eigenvalue of (3<nn> - 1)/2, n the cells' shortest axis: 0 isotropic, 1 aligned"},
      {"tumbling_share", motion, "1", "share of cells whose shortest axis turns by half a turn or more in the shear plane within 11 strains"},
      {"steady_share", motion, "1", "share of cells whose shortest axis doesn't: tank-treading, swinging"},
      {"rolling_share", motion, "1", "share of cells whose shortest axis stays within 30 degrees of the vorticity axis"},
      {"half_turns", motion, "1/strain", "half turns of a tumbling cell per strain"},
      {"tumbling_period", motion, "strain", "time in which the shortest axis of a cell turns once in the shear plane, from its passages through the gradient direction"},
      {"contact_number", structure, "1", "mean number of neighbours whose centres are nearer than the contact distance"},
      {"area_drift_max", drift, "1", "largest |A/A_0 - 1| of all cells in the whole run"},
      {"volume_drift_max", drift, "1", "largest |V/V_0 - 1| of all cells in the whole run"},
  };
  return table;
}

const std::vector<NamedCurve>& all_curves() {
  using enum Group;
  const std::string height = "$z/r$", lag = R"($\dot\gamma t$)";
  static const std::vector<NamedCurve> table{
      {"profile_phi", structure, "r", "1", height, R"($\phi_{\mathrm{eff}}$)", "effective volume fraction by cells' centres in layers of z"},
      {"profile_velocity", velocity, "r", "gamma_dot r", height, R"($u_x/(\dot\gamma r)$)", "mean velocity of the cells along x"},
      {"profile_stress_xz", stress, "r", "eta_0 gamma_dot", height, R"($\sigma_{xz}/(\eta_0\dot\gamma)$)", "stress of the cells with their centre in a layer / its volume"},
      {"profile_variance_x", velocity, "r", "(gamma_dot r)^2", height, R"($\langle\delta u_x^2\rangle/(\dot\gamma r)^2$)", "velocity variance along x"},
      {"profile_variance_y", velocity, "r", "(gamma_dot r)^2", height, R"($\langle\delta u_y^2\rangle/(\dot\gamma r)^2$)", "velocity variance along y"},
      {"profile_variance_z", velocity, "r", "(gamma_dot r)^2", height, R"($\langle\delta u_z^2\rangle/(\dot\gamma r)^2$)", "velocity variance along z"},
      {"profile_deformation", shape, "r", "1", height, "$D$", "mean deformation in the shear plane"},
      {"pdf_velocity_x", velocity, "gamma_dot r", "1/(gamma_dot r)", R"($\delta u_x/(\dot\gamma r)$)", "$p$", "probability density of the velocity fluctuations along x"},
      {"pdf_velocity_y", velocity, "gamma_dot r", "1/(gamma_dot r)", R"($\delta u_y/(\dot\gamma r)$)", "$p$", "probability density of the velocity fluctuations along y"},
      {"pdf_velocity_z", velocity, "gamma_dot r", "1/(gamma_dot r)", R"($\delta u_z/(\dot\gamma r)$)", "$p$", "probability density of the velocity fluctuations along z"},
      {"pdf_stresslet", stress, "1", "1", R"($S_{xz}/\langle S_{xz}\rangle$)", "$p$", "probability density of the cells' xz stresslets over their mean"},
      {"vacf_x", velocity, "strain", "1", lag, R"($C_v(t)/C_v(0)$)", "velocity autocorrelation along x"},
      {"vacf_y", velocity, "strain", "1", lag, R"($C_v(t)/C_v(0)$)", "velocity autocorrelation along y"},
      {"vacf_z", velocity, "strain", "1", lag, R"($C_v(t)/C_v(0)$)", "velocity autocorrelation along z"},
      {"displacement_acf_y", diffusion, "strain", "1", lag, R"($C_{\Delta y}(t)/C_{\Delta y}(0)$)", "autocorrelation of the displacements along y over a window of 0.1 strains"},
      {"displacement_acf_z", diffusion, "strain", "1", lag, R"($C_{\Delta z}(t)/C_{\Delta z}(0)$)", "autocorrelation of the displacements along z over a window of 0.1 strains"},
      {"msd_y", diffusion, "strain", "r^2", lag, R"($\langle\Delta y^2\rangle/r^2$)", "mean square displacement along y"},
      {"msd_z", diffusion, "strain", "r^2", lag, R"($\langle\Delta z^2\rangle/r^2$)", "mean square displacement along z"},
      {"msd_exponent_y", diffusion, "strain", "1", lag, R"($\mathrm{d}\ln\,\mathrm{MSD}/\mathrm{d}\ln t$)", "local exponent of the mean square displacement along y"},
      {"msd_exponent_z", diffusion, "strain", "1", lag, R"($\mathrm{d}\ln\,\mathrm{MSD}/\mathrm{d}\ln t$)", "local exponent of the mean square displacement along z"},
      {"stress_autocorrelation", rheology, "strain", "1", lag, R"($C_\sigma(t)/C_\sigma(0)$)", "autocorrelation of the bulk's particle stress xz"},
      {"stresslet_autocorrelation", stress, "strain", "1", lag, R"($C_S(t)/C_S(0)$)", "autocorrelation of the cells' own xz stresslets"},
      {"pair_distribution", structure, "r", "1", "distance$/r$", "$g$", "pair distribution of the cells' centres"},
  };
  return table;
}

const std::vector<NamedFit>& all_fits() {
  using enum Group;
  const std::string stretched = "amplitude exp[-(t/time)^exponent]", line = "intercept + slope t";
  const std::string core = "core_height exp[-(x - core_centre)^2/(2 core_width^2)]; beyond lower_start and upper_start height exp(-abs(x - start)/decay)";
  static const std::vector<NamedFit> table{
      {"vacf_y_stretched_exponential", velocity, stretched, "vacf_y"}, {"vacf_z_stretched_exponential", velocity, stretched, "vacf_z"},
      {"pdf_velocity_x_core_and_tails", velocity, core, "pdf_velocity_x"}, {"pdf_velocity_y_core_and_tails", velocity, core, "pdf_velocity_y"},
      {"pdf_velocity_z_core_and_tails", velocity, core, "pdf_velocity_z"}, {"msd_y_line", diffusion, line, "msd_y"},
      {"msd_z_line", diffusion, line, "msd_z"},
  };
  return table;
}

template <class List>
auto& entry(List& list, const std::string& name) {
  const auto found = std::find_if(list.begin(), list.end(), [&](const auto& item) { return item.name == name; });
  if (found == list.end()) throw std::logic_error("no result is called " + name);
  return *found;
}

}  // namespace

Analysis::Analysis() : estimates(all_estimates()), curves(all_curves()), fits(all_fits()) {
  tensors.push_back({"orientation", Group::shape, "1", "<nn> of the cells' shortest axis, bulk: trace 1, a third each when isotropic"});
}

statistics::Estimate& Analysis::estimate(const std::string& name) { return entry(estimates, name).estimate; }
const statistics::Estimate& Analysis::estimate(const std::string& name) const { return entry(estimates, name).estimate; }
statistics::Curve& Analysis::curve(const std::string& name) { return entry(curves, name).curve; }
const statistics::Curve& Analysis::curve(const std::string& name) const { return entry(curves, name).curve; }
NamedFit& Analysis::fit(const std::string& name) { return entry(fits, name); }
const NamedFit& Analysis::fit(const std::string& name) const { return entry(fits, name); }
NamedTensor& Analysis::tensor(const std::string& name) { return entry(tensors, name); }

void Analysis::refuse(Group group, const std::string& reason) {
  for (auto& item : estimates)
    if (item.group == group) item.estimate = {.reason = reason};
  for (auto& item : curves)
    if (item.group == group) item.curve = {.reason = reason};
  for (auto& item : fits)
    if (item.group == group) item.fit = {.reason = reason};
  for (auto& item : tensors)
    if (item.group == group) item.reason = reason;
}

void Analysis::doubt_averages(const std::string& reason) {
  for (auto& item : estimates)
    if (item.group != Group::drift) statistics::doubt(item.estimate, reason);
  for (auto& item : curves) statistics::doubt(item.curve, reason);
  for (auto& item : fits) statistics::doubt(item.fit, reason);
  for (auto& item : tensors) statistics::doubt(item, reason);
}

}  // namespace corpuscle::analysis
