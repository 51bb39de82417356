#include "io/scene_si.hpp"

#include <algorithm>

namespace corpuscle::scene {
namespace {

constexpr Dimension metre{0, 1, 0}, second{0, 0, 1}, per_second{0, 0, -1}, newton{1, 1, -2}, newton_per_metre{1, 0, -2}, joule{1, 2, -2};
constexpr Dimension pascal_second{1, -1, -1};

/// The value, or 0 and its key in the list of what is missing.
double given(const std::optional<double>& value, const char* key, std::string& missing) {
  if (!value && missing.find(key) == std::string::npos) missing += (missing.empty() ? "" : ", ") + std::string(key);
  return value.value_or(0);
}
double radius(const SiSpec& si, std::string& missing) { return given(si.radius, "si.radius", missing); }
double kappa(const SiSpec& si, std::string& missing) { return 3 * given(si.shear_modulus, "si.shear_modulus", missing); }

/// eta_0 r / kappa_S: the time in which a membrane of the scene relaxes.
double membrane_time(const SiSpec& si, std::string& missing) {
  const double drag = given(si.viscosity, "si.viscosity", missing) * radius(si, missing), stiffness = kappa(si, missing);
  return missing.empty() ? drag / stiffness : 0;
}

/// Unit of output cadences (docs/scene.md): 1/shear_rate, or at rest the unit of run.duration.
double cadence(const Problem& p, const CellSpec&, std::string& missing) {
  if (p.flow.kind != FlowKind::rest && p.si.shear_rate) return 1 / *p.si.shear_rate;
  const double time = membrane_time(p.si, missing);
  if (p.flow.kind == FlowKind::rest) {
    if (!p.run.duration) missing += (missing.empty() ? "" : ", ") + std::string("run.duration (instead of run.steps)");
    return time;
  }
  const double ca = p.flow.capillary_number ? *p.flow.capillary_number : p.flow.capillary_number_G.value_or(0) / 3;
  if (!(ca > 0)) missing += (missing.empty() ? "" : ", ") + std::string("si.shear_rate or flow.capillary_number");
  return ca > 0 ? time / ca : 0;
}

double one(const Problem&, const CellSpec&, std::string&) { return 1; }
double length(const Problem& p, const CellSpec&, std::string& missing) { return radius(p.si, missing); }
double length_of_type(const Problem& p, const CellSpec& c, std::string& missing) { return radius(p.si, missing) * c.relative_radius; }
double kappa_of_type(const Problem& p, const CellSpec& c, std::string& missing) { return kappa(p.si, missing) * c.relative_stiffness; }
double shear_modulus(const Problem& p, const CellSpec&, std::string& missing) { return kappa(p.si, missing) / 3; }
double force_of_type(const Problem& p, const CellSpec& c, std::string& missing) { return kappa_of_type(p, c, missing) * length_of_type(p, c, missing); }
double energy_of_type(const Problem& p, const CellSpec& c, std::string& missing) { return force_of_type(p, c, missing) * length_of_type(p, c, missing); }
double duration(const Problem& p, const CellSpec&, std::string& missing) { return membrane_time(p.si, missing); }

const SiKey table[] = {
    {"si.radius", "m", "3.91 um", metre, one},
    {"si.viscosity", "Pa s", "1.2 mPa s", pascal_second, one},
    {"si.shear_modulus", "N/m", "5.3 uN/m", newton_per_metre, one},
    {"si.shear_rate", "1/s", "100 1/s", per_second, one},
    {"box.size", "m", "20 um", metre, length},
    {"cells.*.position", "m", "20 um", metre, length},
    {"cells.*.relative_radius", "m", "3 um", metre, length, true},
    {"cells.*.relative_stiffness", "N/m, G_s", "5.3 uN/m", newton_per_metre, shear_modulus, true},
    {"cells.*.membrane.bending", "J", "2e-19 J", joule, energy_of_type},
    {"cells.*.membrane.global_area", "N/m", "1 mN/m", newton_per_metre, kappa_of_type},
    {"cells.*.stretch.force", "N", "67.7 pN", newton, force_of_type},
    {"cells.*.stretch.patch_diameter", "m", "2 um", metre, length_of_type},
    {"run.duration", "s", "50 ms", second, duration, true},
    {"output.series_every", "s", "1 ms", second, cadence},
    {"output.snapshot_every", "s", "10 ms", second, cadence},
};

}  // namespace

const SiKey* find_si_key(std::string_view name) {
  const auto found = std::find_if(std::begin(table), std::end(table), [&](const SiKey& key) { return key.name == name; });
  return found == std::end(table) ? nullptr : &*found;
}

double capillary_number(const SiSpec& si, std::string& missing) {
  const double time = membrane_time(si, missing);
  return time * si.shear_rate.value_or(0);
}

}  // namespace corpuscle::scene
