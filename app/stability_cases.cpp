#include "app/stability_cases.hpp"

#include <fmt/format.h>

#include <cmath>

#include "io/scene_keys.hpp"
#include "physics/stability_limits.hpp"

namespace corpuscle::app {
namespace {

using Kind = ProbeScene::Kind;
constexpr int kernels[] = {2, 3, 4};

std::vector<std::string> update_names() {
  std::vector<std::string> names;
  for (const auto& name : scene::choice_list(*scene::find_key("accuracy.vertex_update"))) names.emplace_back(name);
  return names;
}

class List {
 public:
  std::vector<StabilityCase> cases;

  /// `where` beyond the scene's kind, kernel, update and tau, which all conditions begin with.
  StabilityCase& add(const char* parameter, const char* unit, const ProbeScene& scene, LimitSearch search, std::function<void(ProbeScene&, double)> set,
                     const std::string& where = "") {
    StabilityCase c;
    c.parameter = parameter;
    c.unit = unit;
    c.scene = scene;
    c.search = search;
    c.set = std::move(set);
    c.shown = [](double v) { return v; };
    c.conditions = scene.kind == Kind::fluid_only
                       ? fmt::format("fluid alone, {}, tau = {:g}", scene.collision == CollisionKind::bgk ? "BGK" : "TRT", scene.relaxation_time)
                       : fmt::format("{}, {} points, {}, tau = {:g}", scene.kind == Kind::at_rest ? "at rest" : "in flow", scene.delta_kernel, updates[int(scene.update)],
                                     scene.relaxation_time);
    if (!where.empty()) c.conditions += ", " + where;
    cases.push_back(std::move(c));
    return cases.back();
  }

  const std::vector<std::string> updates = update_names();
};

void set_shear(ProbeScene& s, double v) { s.shear = v; }
void set_dilation(ProbeScene& s, double v) { s.dilation = v; }
void set_bending(ProbeScene& s, double v) { s.bending = v; }
void set_red_cell(ProbeScene& s, double v) { s.set_red_cell(v); }
void set_area(ProbeScene& s, double v) { s.area = v; }
void set_volume(ProbeScene& s, double v) { s.volume = v; }
void set_contact(ProbeScene& s, double v) { s.contact = v; }
void set_mach(ProbeScene& s, double v) { s.mach = v; }
void set_capillary_number(ProbeScene& s, double v) { s.capillary_number = v; }

ProbeScene scene_of(Kind kind, int kernel, int update, double tau = 1) {
  ProbeScene s;
  s.steps = kind == Kind::at_rest ? 1500 : 2000;
  s.kind = kind;
  s.delta_kernel = kernel;
  s.update = VertexUpdate(update);
  s.relaxation_time = tau;
  return s;
}

/// In flow the membrane is a soft red cell but for the searched modulus.
ProbeScene soft_in_flow(int kernel, int update, double tau = 1) {
  ProbeScene s = scene_of(Kind::in_flow, kernel, update, tau);
  s.set_red_cell(0.1);
  return s;
}

const LimitSearch modulus{4, 0.02, 300, 1.15};  // kappa / eta_0
const LimitSearch bending{2, 0.02, 100, 1.15};
const LimitSearch response{1, 0.02, 100, 1.15};

void stiffness_in_flow(List& list, int u) {
  for (const int kernel : kernels)
    for (const double tau : {1.0, 0.6, 2.0}) list.add("red_cell", "eta_0", soft_in_flow(kernel, u, tau), modulus, set_red_cell);
  for (const int kernel : kernels) {
    list.add("kappa_S", "eta_0", soft_in_flow(kernel, u), modulus, set_shear);
    list.add("kappa_alpha", "eta_0", soft_in_flow(kernel, u), modulus, set_dilation);
  }
}

void fractions_and_contact(List& list, int u) {
  for (const int kernel : {3, 4})
    for (const double phi : {0.2, 0.66, 0.88}) {
      ProbeScene s = soft_in_flow(kernel, u);
      s.phi = phi;
      list.add("phi_eff", "eta_0", s, modulus, set_red_cell, fmt::format("phi_eff = {:g}", phi));
    }
  for (const int kernel : kernels) list.add("contact", "eta_0", soft_in_flow(kernel, u), LimitSearch{4, 0.1, 1000, 1.15}, set_contact);
  list.add("kappa_B", "eta_0", soft_in_flow(3, u), bending, set_bending);
  list.add("kappa_A", "response", soft_in_flow(3, u), response, set_area);
  for (const double tau : {1.0, 0.6}) list.add("kappa_V", "response", soft_in_flow(3, u, tau), response, set_volume);
  ProbeScene stiff = soft_in_flow(3, u);
  stiff.dilation = 3;  // as in the paper's suspensions: breathing and dilation act together
  list.add("kappa_V", "response", stiff, response, set_volume, "kappa_alpha = 3 eta_0");
  list.add("kappa_A", "response", stiff, response, set_area, "kappa_alpha = 3 eta_0");
}

void stiffness_at_rest(List& list, int u) {
  for (const int kernel : kernels)
    for (const int frequency : {5, 13, 7, 3, 2}) {  // of the icosahedron: edges of r/frequency
      ProbeScene s = scene_of(Kind::at_rest, kernel, u);
      s.edge = s.radius / frequency;
      const std::string edge = fmt::format("edge = {:.2g}", s.edge);
      list.add("kappa_S", "eta_0", s, modulus, set_shear, edge);
      list.add("kappa_alpha", "eta_0", s, modulus, set_dilation, edge);
      if (frequency == 5 || (kernel == 3 && frequency != 13 && frequency != 2)) list.add("kappa_B", "eta_0", s, bending, set_bending, edge);
    }
  for (const int kernel : kernels)
    for (const double tau : {1.0, 0.6, 2.0}) list.add("red_cell", "eta_0", scene_of(Kind::at_rest, kernel, u, tau), modulus, set_red_cell);
}

void global_terms(List& list, int u) {
  const auto add = [&](int kernel, double radius, double tau) {
    ProbeScene s = scene_of(Kind::at_rest, kernel, u, tau);
    s.radius = radius;
    s.set_red_cell(0.3);
    list.add("kappa_A", "response", s, response, set_area, fmt::format("r = {:g}", radius));
    list.add("kappa_V", "response", s, response, set_volume, fmt::format("r = {:g}", radius));
  };
  for (const int kernel : kernels) add(kernel, 5, 1);
  add(3, 8, 1);
  add(3, 5, 2);
  ProbeScene large = scene_of(Kind::at_rest, 3, u);
  large.radius = 12;
  large.set_red_cell(0.3);
  list.add("kappa_V", "response", large, LimitSearch{0.7, 0.02, 100, 1.15}, set_volume, "r = 12");
  for (const double tau : {1.0, 0.6}) {
    ProbeScene flow = soft_in_flow(3, u, tau);
    flow.radius = 8;
    flow.steps = 1000;
    list.add("kappa_V", "response", flow, LimitSearch{0.7, 0.02, 100, 1.2}, set_volume, "r = 8");
  }
}

/// Membranes and fluid coupled every few steps only.
void coupling_intervals(List& list, int u) {
  const auto add = [&](const char* parameter, const char* unit, ProbeScene s, int interval, const LimitSearch& search, void (*set)(ProbeScene&, double)) {
    s.coupling_every = interval;
    s.volume /= interval;  // what isn't searched for must keep clear of its own limit
    s.area /= interval;
    list.add(parameter, unit, s, search, set, fmt::format("coupled every {} steps", interval));
  };
  const auto red_cell = [&](int kernel, double tau, int interval) {
    add("coupling", "eta_0", soft_in_flow(kernel, u, tau), interval, LimitSearch{7.0 / interval, 0.02, 300, 1.15}, set_red_cell);
  };
  if (VertexUpdate(u) == VertexUpdate::chebyshev) {
    const LimitSearch stiff{20, 0.02, 300, 1.15};
    for (const double tau : {1.0, 0.6}) add("coupling", "eta_0", soft_in_flow(3, u, tau), 4, stiff, set_red_cell);
    return;
  }
  for (const int interval : {2, 3, 4, 8}) red_cell(3, 1, interval);
  for (const int kernel : {2, 4})
    for (const int interval : {2, 4}) red_cell(kernel, 1, interval);
  for (const double tau : {0.6, 2.0})
    for (const int interval : {2, 4}) red_cell(3, tau, interval);
  add("kappa_V", "response", soft_in_flow(3, u), 4, LimitSearch{0.4, 0.02, 100, 1.15}, set_volume);
  add("contact", "eta_0", soft_in_flow(3, u), 4, LimitSearch{100, 0.1, 1000, 1.15}, set_contact);
}

void precision(List& list, int u) {
  ProbeScene s = soft_in_flow(3, u);
  s.precision = Precision::single_precision;
  list.add("precision", "eta_0", s, modulus, set_red_cell, "single precision");
}

/// The same at a finer resolution, where bending has a larger share.
void resolution(List& list, int u) {
  ProbeScene s = soft_in_flow(3, u);
  s.radius = 8;
  list.add("red_cell", "eta_0", s, modulus, set_red_cell, "r = 8");
}

void capillary_numbers(List& list) {
  ProbeScene s = soft_in_flow(3, 0);
  s.steps = 6000;
  list.add("Ca", "", s, LimitSearch{10, 0.1, 100, 1.15}, set_capillary_number, "Re = 0.1, 4 strain units");
}

/// tau - 1/2 is searched as its inverse, whose limit is an upper one.
void fluid(List& list) {
  for (const auto collision : {CollisionKind::bgk, CollisionKind::trt}) {
    for (const double tau : {0.51, 0.55, 0.6, 1.0, 2.0, 5.0}) {
      ProbeScene s = scene_of(Kind::fluid_only, 3, 0, tau);
      s.collision = collision;
      list.add("Mach", "c_s", s, LimitSearch{0.5, 0.01, 3, 1.1}, set_mach);
    }
    for (const double mach : {0.1, 0.3}) {
      ProbeScene s = scene_of(Kind::fluid_only, 3, 0, 1);
      s.collision = collision;
      s.mach = mach;
      auto& c = list.add("tau", "", s, LimitSearch{100, 1, 1e4, 1.15}, [](ProbeScene& at, double v) { at.relaxation_time = 0.5 + 1 / v; });
      c.conditions = fmt::format("fluid alone, {}, Ma = {:g}", collision == CollisionKind::bgk ? "BGK" : "TRT", mach);
      c.shown = [](double v) { return 0.5 + 1 / v; };
      c.smallest = true;
    }
    ProbeScene s = soft_in_flow(3, 0);
    s.collision = collision;
    auto& c = list.add("tau", "", s, LimitSearch{50, 1, 200, 1.15}, [](ProbeScene& at, double v) {
      at.relaxation_time = 0.5 + 1 / v;
      at.set_red_cell(1);
      AccuracySpec accuracy;  // the default volume force of such a scene
      accuracy.relaxation_time = at.relaxation_time;
      at.volume = stability_margin * stable_response(accuracy);
    });
    c.conditions = fmt::format("in flow, 3 points, {}, {}, kappa_S = eta_0", list.updates[0], collision == CollisionKind::bgk ? "BGK" : "TRT");
    c.shown = [](double v) { return 0.5 + 1 / v; };
    c.smallest = true;
  }
}

}  // namespace

std::vector<StabilityCase> stability_cases() {
  List list;
  for (int u = 0; u < int(list.updates.size()); ++u) {
    stiffness_in_flow(list, u);
    fractions_and_contact(list, u);
    stiffness_at_rest(list, u);
    global_terms(list, u);
    precision(list, u);
    resolution(list, u);
    if (VertexUpdate(u) != VertexUpdate::euler) coupling_intervals(list, u);
    if (u == 0) {  // what has to do with the fluid, or with large deformation, doesn't depend on the update
      capillary_numbers(list);
      fluid(list);
    }
  }
  return std::move(list.cases);
}

}  // namespace corpuscle::app
