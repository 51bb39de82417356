// What is measured at one instant, on the host, in lattice units unless stated otherwise. Written by io/, analysed by physics/statistics.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace corpuscle {

/// One cell at one instant.
struct CellSample {
  std::array<double, 3> centre{};     ///< centroid of the enclosed volume, unwrapped
  std::array<double, 3> velocity{};   ///< mean velocity of the vertices
  std::array<double, 6> gyration{};   ///< second moment of the enclosed volume / volume, about the centre: xx yy zz xy xz yz
  std::array<double, 9> stresslet{};  ///< - sum_v F_a r_b (membrane and half of each pair repulsion), row a, column b; lattice energy units
  double volume = 0;
  double area = 0;
  std::array<double, 3> extent{};     ///< largest distance between two vertices along x, y and z
};

/// The whole suspension at one instant.
struct Sample {
  std::int64_t step = 0;
  double strain = 0;                            ///< shear_rate * step (0 at rest)
  std::array<double, 9> particle_stress{};      ///< sigma^p_ab, sum of stresslets / box volume
  std::array<double, 9> bulk_particle_stress{}; ///< the same over the cells whose centre lies outside the wall layers / bulk volume
  std::array<double, 2> wall_shear_stress{};    ///< xz at the lower and the upper wall; NaN without walls
  double relative_viscosity = 0;                ///< 1 + sigma^p_xz/(eta_0 shear_rate) with the whole box; NaN at rest
  double bulk_relative_viscosity = 0;           ///< the same in the bulk (layer of 4 r at each wall left out; whole box where no bulk is left)
  double wall_relative_viscosity = 0;           ///< mean of both walls / (eta_0 shear_rate); NaN without walls
  double normal_stress_difference_1 = 0;        ///< (sigma_xx - sigma_zz)/(eta_0 shear_rate)
  double normal_stress_difference_2 = 0;        ///< (sigma_zz - sigma_yy)/(eta_0 shear_rate); z is the gradient direction
  double particle_pressure = 0;                 ///< - trace(sigma^p)/3/(eta_0 shear_rate)
  double mean_deformation = 0;                  ///< mean over cells of D = (L-B)/(L+B) in the shear plane
  double volume_drift_max = 0;                  ///< max over cells |V/V_0 - 1|
  double area_drift_max = 0;                    ///< max over cells |A/A_0 - 1|
  double velocity_max = 0;                      ///< largest vertex speed
  std::vector<CellSample> cells;                ///< ordered by type, then by number
};

/// Vertex data of all cells at one instant, ordered by type, cell, vertex.
struct Snapshot {
  std::int64_t step = 0;
  double strain = 0;
  std::vector<double> positions;   ///< [vertices][3], unwrapped
  std::vector<double> velocities;  ///< [vertices][3]
  std::vector<float> fluid_velocity;  ///< [nz][ny][nx][3]; empty unless asked for
};

}  // namespace corpuscle
