// The groups of observables, one file each. Every function fills in its names of the catalogue, or says why it can't; all take the same steady state.
#pragma once
#include "physics/analysis/results.hpp"
#include "physics/analysis/steady_state.hpp"
#include "physics/statistics/profile.hpp"

namespace corpuscle::analysis {

void add_rheology(const SteadyState& state, Analysis& analysis);      ///< stresses of the bulk, of the box and at the walls
void add_structure(const SteadyState& state, Analysis& analysis);     ///< volume fractions, pair distribution, contacts
void add_velocities(const SteadyState& state, Analysis& analysis);    ///< mean flow, fluctuations, their densities and correlations
void add_gap(const SteadyState& state, Analysis& analysis);           ///< from rheology, structure and velocities, which come before
void add_diffusion(const SteadyState& state, Analysis& analysis);     ///< displacements along y and z
void add_stresslets(const SteadyState& state, Analysis& analysis);    ///< stress of single cells
void add_shapes(const SteadyState& state, Analysis& analysis);        ///< deformation, orientation, motion

/// Layers of z across the box, half a radius thick (thicker where that would be more than 150). `series`, the mean over the cells, tells how long blocks must be.
statistics::ProfileOptions layers_of(const SteadyState& state, const std::vector<double>& series);
/// x in radii, values and errors divided by `unit`, of a profile in lattice units; doubted where the steady part is too short for `series`.
statistics::Curve profile_curve(const SteadyState& state, const statistics::BlockedCurve& profile, double unit, const std::vector<double>& series);

}  // namespace corpuscle::analysis
