#include "physics/shear_rate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "core/limit_text.hpp"
#include "physics/stability_limits.hpp"

namespace corpuscle {
namespace {

constexpr double stiffness_at_rest = 0.25;  // kappa_S / eta_0 where no flow sets it: soft, and well inside the limit

class ShearRateChoice {
 public:
  ShearRateChoice(const Problem& problem, LatticeParameters& lattice) : p_(problem), l_(lattice) {
    if (p_.flow.capillary_number) ca_ = *p_.flow.capillary_number;
    else if (p_.flow.capillary_number_G) ca_ = *p_.flow.capillary_number_G / 3;
    for (std::size_t i = 0; i < p_.cells.size(); ++i) modulus_.push_back(moduli_limits(i));
  }

  /// Returns kappa_S of the scene; 0 without cells.
  double choose() {
    const bool cells = !p_.cells.empty();
    const double eta = l_.viscosity;
    double kappa = cells ? p_.accuracy.shear_modulus.value_or(0) : 0;
    if (kappa > 0) check_modulus(kappa);
    if (p_.flow.kind == FlowKind::rest) {
      return !cells || kappa > 0 ? kappa : std::min(stiffness_at_rest * eta, stability_margin * largest_modulus());
    }
    velocity_per_rate_ = l_.nodes[2] / (p_.flow.kind == FlowKind::shear ? 2.0 : 4.0);  // wall speed; centre-line speed gamma_w H/4
    add("reynolds_number_max", p_.flow.reynolds_number_max * eta / (l_.radius * l_.radius));
    add("mach_max", p_.accuracy.mach_max * speed_of_sound / velocity_per_rate_);
    if (cells && kappa > 0 && p_.accuracy.shear_rate) {
      ca_ = eta * *p_.accuracy.shear_rate * l_.radius / kappa;  // both fixed: they state the capillary number
    } else if (cells) {
      if (!(ca_ > 0)) throw InputError("flow.capillary_number is missing: cells in a flow need it, a number > 0 such as 0.081 (or flow.capillary_number_G)");
      const double rate_per_modulus = ca_ / (eta * l_.radius);
      for (const auto& [name, modulus] : smallest_limits()) add_stability(name, rate_per_modulus * modulus);
      if (kappa > 0) fixed("shear_modulus", kappa, rate_per_modulus * kappa);
    }
    if (cells) add_stability("compression of the fluid", p_.guards.density / crowding_density(l_.phi_effective, ca_, eta, 1));
    if (p_.accuracy.shear_rate) fixed("shear_rate", *p_.accuracy.shear_rate, *p_.accuracy.shear_rate);
    std::stable_sort(l_.limits.begin(), l_.limits.end(), [](const auto& a, const auto& b) { return a.shear_rate < b.shear_rate; });
    if (!fixed_by_.empty()) {  // it may exceed the next limit by rounding, or lie in the margin of stability
      std::stable_partition(l_.limits.begin(), l_.limits.end(), [&](const auto& limit) { return limit.name == fixed_by_; });
    }
    l_.shear_rate = l_.limits.front().shear_rate;
    if (!cells) return 0;
    if (!(kappa > 0)) kappa = eta * l_.shear_rate * l_.radius / ca_;
    l_.capillary_number = ca_;
    return kappa;
  }

 private:
  /// Largest stable kappa_S of the scene as a part of a cell type bounds it; infinite where that part doesn't depend on kappa_S.
  struct ModulusLimit {
    double membrane, volume, area, contact;
  };

  void add(const char* name, double rate) {
    l_.limits.push_back({name, rate});
    hard_.push_back({name, rate});
  }
  /// A stability limit is used up to its margin, but refuses only what is beyond it.
  void add_stability(const char* name, double rate) {
    l_.limits.push_back({name, stability_margin * rate});
    stability_.push_back({name, rate});
  }

  double load_per_modulus(std::size_t i) const {
    const CellSpec& spec = p_.cells[i];
    const double relative = spec.relative_stiffness / l_.viscosity;
    return stiffness_load(stiffness_, l_.cells[i].edge, relative, relative * dilation_ratio(spec), relative * bending_ratio(i));
  }
  static double dilation_ratio(const CellSpec& spec) { return dilation_stiffness(spec.membrane.law, 1, spec.membrane.area_dilation); }
  double bending_ratio(std::size_t i) const { return p_.cells[i].membrane.bending * l_.cells[i].radius * l_.cells[i].radius; }

  ModulusLimit moduli_limits(std::size_t i) const {
    const CellSpec& spec = p_.cells[i];
    const CellTypeLattice& cell = l_.cells[i];
    const double none = std::numeric_limits<double>::infinity();
    const double volume = spec.membrane.volume.value_or(0) * spec.relative_stiffness / cell.radius, area = spec.membrane.global_area.value_or(0) * spec.relative_stiffness;
    return {1 / load_per_modulus(i), volume > 0 ? volume_modulus(cell, stable_response(p_.accuracy)) / volume : none, area > 0 ? area_modulus(cell, stable_area_response(p_.accuracy)) / area : none,
            p_.contact.enabled ? stiffness_.contact * l_.viscosity / p_.contact.strength : none};
  }

  /// The smallest of each kind, where there is one.
  std::vector<std::pair<const char*, double>> smallest_limits() const {
    std::vector<std::pair<const char*, double>> limits;
    const std::pair<const char*, double ModulusLimit::*> kinds[] = {{"membrane stability", &ModulusLimit::membrane}, {"volume stability", &ModulusLimit::volume},
                                                                    {"area stability", &ModulusLimit::area}, {"contact stability", &ModulusLimit::contact}};
    for (const auto& [name, member] : kinds) {
      double least = std::numeric_limits<double>::infinity();
      for (const ModulusLimit& limit : modulus_) least = std::min(least, limit.*member);
      if (std::isfinite(least)) limits.emplace_back(name, least);
    }
    return limits;
  }
  double largest_modulus() const {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& limit : smallest_limits()) least = std::min(least, limit.second);
    return least;
  }

  void check_modulus(double kappa) {
    const double allowed = kappa * (1 - limit_tolerance);
    const auto too_stiff = [&](const std::string& key, double value, double largest, const char* instead) {
      refuse_unstable(p_, l_, fmt::format("{} = {} is unstable with accuracy.shear_modulus = {}: it must be <= {}; {}", key, value, kappa, at_most(largest), instead));
    };
    for (std::size_t i = 0; i < p_.cells.size(); ++i) {
      const CellSpec& spec = p_.cells[i];
      const std::string at = fmt::format("cells.{}.membrane.", i);
      const ModulusLimit& limit = modulus_[i];
      if (allowed > limit.membrane) {
        // Which modulus to lower: the one with the largest share, if the others leave room for it.
        const double relative = kappa * spec.relative_stiffness / l_.viscosity, edge = l_.cells[i].edge;
        const double shear = stiffness_load(stiffness_, edge, relative, 0, 0), dilation = stiffness_load(stiffness_, edge, 0, relative * dilation_ratio(spec), 0);
        const double bending = stiffness_load(stiffness_, edge, 0, 0, relative * bending_ratio(i));
        if (spec.membrane.law == StrainLawKind::skalak && dilation > std::max(shear, bending) && shear + bending < 1)
          too_stiff(at + "area_dilation", spec.membrane.area_dilation, spec.membrane.area_dilation * (1 - shear - bending) / dilation, "or lower the modulus");
        else if (bending > std::max(shear, dilation) && shear + dilation < 1)
          too_stiff(at + "bending", spec.membrane.bending, spec.membrane.bending * (1 - shear - dilation) / bending, "or lower the modulus");
        else
          refuse_unstable(p_, l_, fmt::format("accuracy.shear_modulus = {} is unstable with accuracy.relaxation_time = {}{}: it must be <= {}", kappa, l_.relaxation_time,
                                              spec.relative_stiffness != 1 ? fmt::format(" and cells.{}.relative_stiffness = {}", i, spec.relative_stiffness) : "",
                                              at_most(limit.membrane)));
      }
      if (allowed > limit.volume) too_stiff(at + "volume", *spec.membrane.volume, *spec.membrane.volume * limit.volume / kappa, "or leave it out for a stable default");
      if (allowed > limit.area) too_stiff(at + "global_area", *spec.membrane.global_area, *spec.membrane.global_area * limit.area / kappa, "or leave it out for a stable default");
    }
    if (!modulus_.empty() && allowed > modulus_[0].contact) too_stiff("contact.strength", p_.contact.strength, p_.contact.strength * modulus_[0].contact / kappa, "or lower the modulus");
  }

  /// A key of [accuracy] fixes the rate: it becomes the deciding limit, unless another limit is lower, which is an error.
  void fixed(const char* key, double value, double rate) {
    const auto lowest = *std::min_element(hard_.begin(), hard_.end(), [](const auto& a, const auto& b) { return a.shear_rate < b.shear_rate; });
    const auto too_fast = [&](const ShearRateLimit& limit, const std::string& way_out) {
      return fmt::format("accuracy.{} = {} gives the shear rate {:.4g}, above the largest that {} allows ({:.4g}): it must be <= {}{}", key, value, rate, limit.name,
                         limit.shear_rate, at_most(value * limit.shear_rate / rate), way_out);
    };
    if (rate > lowest.shear_rate * (1 + limit_tolerance)) {
      std::string way_out;
      if (lowest.name == "reynolds_number_max") way_out = "; or raise flow.reynolds_number_max to " + at_least(p_.flow.reynolds_number_max * rate / lowest.shear_rate);
      const double mach = rate * velocity_per_rate_ / speed_of_sound;
      if (lowest.name == "mach_max" && mach <= 0.3) way_out = "; or raise accuracy.mach_max to " + at_least(mach);
      throw InputError(too_fast(lowest, way_out));
    }
    if (!p_.accuracy.shear_modulus) {  // else check_modulus has told
      for (const ShearRateLimit& limit : stability_)
        if (rate > limit.shear_rate * (1 + limit_tolerance)) refuse_unstable(p_, l_, too_fast(limit, ""));
    }
    l_.limits.push_back({key, rate});
    fixed_by_ = key;
  }

  const Problem& p_;
  LatticeParameters& l_;
  StiffnessLimits stiffness_ = stiffness_limits(p_.accuracy, l_.phi_effective);
  std::vector<ModulusLimit> modulus_;  // of each cell type
  double ca_ = 0;
  std::vector<ShearRateLimit> hard_, stability_;  // what may not be exceeded; what may be with accuracy.allow_unstable
  double velocity_per_rate_ = 0;
  std::string fixed_by_;  // key of [accuracy] that fixes the rate
};

}  // namespace

double choose_shear_rate(const Problem& problem, LatticeParameters& lattice) { return ShearRateChoice(problem, lattice).choose(); }

}  // namespace corpuscle
