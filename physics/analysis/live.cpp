#include "physics/analysis/live.hpp"

namespace corpuscle::analysis {

std::pair<RunRecord, Analysis> live_analysis(const LiveStatistics& statistics, const LatticeParameters& lattice) {
  const LiveResults results = statistics.result();
  RunRecord record;
  record.capillary_number = lattice.capillary_number;
  record.phi_geometric = lattice.phi_geometric;
  record.phi_effective = lattice.phi_effective;
  record.radius = lattice.radius;
  record.viscosity = lattice.viscosity;
  record.shear_rate = lattice.shear_rate;
  for (int k = 0; k < 3; ++k) record.box[k] = lattice.nodes[k];
  record.interval = lattice.shear_rate * static_cast<double>(lattice.series_every);
  record.strain = results.to_strain;
  record.samples = results.samples;
  for (const auto& type : lattice.cells)
    record.types.push_back({type.name, type.count, type.effective_radius, type.volume, type.effective_volume});

  Analysis analysis;
  analysis.settings.wall_layer = statistics.wall_layer();
  analysis.settings.mean_flow = MeanFlow::uniform;
  analysis.settings.discarded_strain = analysis.start_up_strain = results.from_strain;
  analysis.settings.longest_lag = statistics::not_a_number;
  analysis.start_up.reason = "not looked for while a run goes on: the share run.discard is left out";
  for (const Group group : {Group::rheology, Group::walls, Group::velocity, Group::gap, Group::diffusion, Group::stress, Group::shape, Group::motion, Group::structure, Group::drift})
    analysis.refuse(group, "not computed while a run goes on: corpuscle analyse computes it from trajectories");
  for (const auto& [name, estimate] : results.estimates) analysis.estimate(name) = estimate;
  for (const auto& [name, curve] : results.curves) analysis.curve(name) = curve;
  for (const auto& [name, fit] : results.fits) analysis.fit(name).fit = fit;
  return {std::move(record), std::move(analysis)};
}

}  // namespace corpuscle::analysis
