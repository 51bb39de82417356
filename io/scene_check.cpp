#include "io/scene_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <set>
#include <vector>

#include "core/error.hpp"
#include "io/scene_keys.hpp"
#include "io/scene_si.hpp"
#include "io/scene_toml.hpp"
#include "physics/resolution_choice.hpp"

namespace corpuscle::scene {

namespace {

class Checker {
 public:
  Checker(Problem& problem, const Given& given, const std::string& origin) : p_(problem), given_(given), origin_(origin) {}

  void run() {
    flow();
    for (std::size_t i = 0; i < p_.cells.size(); ++i) cell(p_.cells[i], fmt::format("cells.{}.", i));
    names();
    duration();
    coupling();
    files();
    meaningless();
    target();
    relaxation_time();
  }

 private:
  bool has(const std::string& key) const { return given_.contains(key); }

  /// "key = value", as the scene gives it.
  std::string said(const std::string& path) {
    const Key& key = *find_key(pattern_of(path));
    CellSpec none;
    CellSpec* owner = path.starts_with("cells.") ? &p_.cells.at(std::stoul(path.substr(6))) : &none;
    return fmt::format("{} = {}", path, value_text(key, key.field(p_, *owner)));
  }

  [[noreturn]] void fail(const std::string& path, const std::string& message) const {
    const auto found = given_.find(path);
    throw InputError((found == given_.end() ? origin_ + ": " : found->second) + message);
  }

  void flow() {
    const bool shear = p_.flow.kind == FlowKind::shear;
    const bool rest = p_.flow.kind == FlowKind::rest;
    if (!p_.box.walls && !rest) {
      fail("box.walls", fmt::format("box.walls = false contradicts flow.kind = \"{}\", which needs walls; only flow.kind = \"rest\" runs without them{}",
                                    shear ? "shear" : "poiseuille", shear ? " (shear between periodic faces isn't available)" : ""));
    }
    const std::vector<std::string> names = {"flow.capillary_number", "flow.capillary_number_G"};
    if (has(names[0]) && has(names[1])) {
      fail(names[1], fmt::format("{} contradicts {}: give one of both (Ca_G = 3 Ca)", said(names[1]), said(names[0])));
    }
    for (const std::string& name : names) {
      if (!has(name)) continue;
      if (rest) fail(name, fmt::format("{} has no meaning with flow.kind = \"rest\": remove it (accuracy.shear_modulus sets the stiffness at rest)", said(name)));
      if (p_.cells.empty()) fail(name, fmt::format("{} has no meaning without cells: remove it or add [[cells]]", said(name)));
      if (has("accuracy.shear_modulus") && has("accuracy.shear_rate")) {
        fail(name, fmt::format("{} contradicts {} and {} together, which fix it already: remove one of the three", said(name), said("accuracy.shear_modulus"), said("accuracy.shear_rate")));
      }
    }
    if (p_.output.statistics && (!shear || p_.cells.empty()))
      fail("output.statistics", fmt::format("output.statistics = true {}: remove it", p_.cells.empty() ? "has no meaning without cells" : "takes flow.kind = \"shear\", the flow that fluctuations are measured against"));
    const bool fixed = has("accuracy.shear_modulus") && has("accuracy.shear_rate");
    if (has("si.shear_rate")) shear_rate();
    if (!rest && !p_.cells.empty() && !p_.flow.capillary_number && !has(names[1]) && !fixed) {
      fail("", "flow.capillary_number is missing: cells in a flow need it, a number > 0 such as 0.081 (or flow.capillary_number_G)");
    }
  }

  /// A physical shear rate becomes a capillary number, so that the merged scene states one thing once.
  void shear_rate() {
    const std::string said_rate = said("si.shear_rate");
    const auto refuse = [&](const std::string& why) { fail("si.shear_rate", fmt::format("{} {}", said_rate, why)); };
    if (p_.flow.kind == FlowKind::rest) refuse("has no meaning with flow.kind = \"rest\": remove it");
    if (p_.cells.empty()) refuse("has no meaning without cells: remove it or add [[cells]]");
    for (const char* name : {"flow.capillary_number", "flow.capillary_number_G"}) {
      if (has(name)) refuse(fmt::format("contradicts {}: give one of both", said(name)));
    }
    if (has("accuracy.shear_modulus") && has("accuracy.shear_rate")) {
      refuse("contradicts accuracy.shear_modulus and accuracy.shear_rate together, which fix the capillary number already: remove one of the three");
    }
    std::string missing;
    const double ca = capillary_number(p_.si, missing);
    if (!missing.empty()) refuse(fmt::format("needs {} to give a capillary number", missing));
    const Range& range = find_key("flow.capillary_number")->range;
    if (!range.contains(ca)) refuse(fmt::format("gives the capillary number {:.4g}, which must be a number {}", ca, range.text()));
    p_.flow.capillary_number = ca;
    p_.si.shear_rate.reset();
  }

  void cell(CellSpec& c, const std::string& at) {
    std::vector<std::string> amounts;
    for (const char* name : {"count", "volume_fraction", "effective_volume_fraction"}) {
      if (has(at + name)) amounts.push_back(at + name);
    }
    if (amounts.size() > 1) fail(amounts[1], fmt::format("{} contradicts {}: give one of both", said(amounts[1]), said(amounts[0])));
    if (amounts.empty()) fail("", fmt::format("{}count is missing: each cell type needs one of count, volume_fraction, effective_volume_fraction", at));

    if (has(at + "file")) {
      if (has(at + "shape") && c.shape != ShapeKind::file) {
        fail(at + "file", fmt::format("{} contradicts {}: remove one of both", said(at + "file"), said(at + "shape")));
      }
      c.shape = ShapeKind::file;
    }
    if (c.shape == ShapeKind::file && c.file.empty()) fail(at + "shape", fmt::format("{}shape = \"file\" needs {}file, the name of an OFF mesh", at, at));

    if (c.position || c.axis) {
      const std::string key = at + (c.position ? "position" : "axis");
      if (c.count != 1) fail(key, fmt::format("{} needs {}count = 1: with more cells of a type their places come from the packing", said(key), at));
      if (!c.position) fail(key, fmt::format("{} needs {}position as well", said(key), at));
    }
    if (c.position) {
      for (int d = 0; d < 3; ++d) {
        if ((*c.position)[d] > p_.box.size[d]) fail(at + "position", fmt::format("{} lies outside of {}", said(at + "position"), said("box.size")));
      }
    }
    if (c.axis && std::hypot((*c.axis)[0], (*c.axis)[1], (*c.axis)[2]) < 1e-9) {
      fail(at + "axis", fmt::format("{} has no direction: at least one component must differ from 0", said(at + "axis")));
    }
    if (std::hypot(c.stretch.direction[0], c.stretch.direction[1], c.stretch.direction[2]) < 1e-9) {
      fail(at + "stretch.direction", fmt::format("{} has no direction: at least one component must differ from 0", said(at + "stretch.direction")));
    }
  }

  /// Names become names of data sets, so they are unique and plain.
  void names() {
    std::set<std::string> taken;
    for (std::size_t i = 0; i < p_.cells.size(); ++i) {
      const std::string& name = p_.cells[i].name;
      const std::string key = fmt::format("cells.{}.name", i);
      if (!has(key)) continue;
      if (name.empty() || name.size() > 64 || !plain(name)) {
        fail(key, fmt::format("{} = {} must be 1 to 64 letters, digits, '_' or '-'", key, quote(one_line(name))));
      }
      if (!taken.insert(name).second) fail(key, fmt::format("{} is the name of another cell type: names must be unique", said(key)));
    }
    for (CellSpec& c : p_.cells) {
      if (!c.name.empty()) continue;
      std::string base(choice_list(*find_key("cells.*.shape")).at(static_cast<std::size_t>(c.shape)));
      if (c.shape == ShapeKind::file) base = std::filesystem::path(c.file).stem().string().substr(0, 48);
      std::replace_if(base.begin(), base.end(), [](char x) { return !plain(std::string(1, x)); }, '_');
      c.name = base;
      for (int n = 2; !taken.insert(c.name).second; ++n) c.name = fmt::format("{}_{}", base, n);
    }
  }

  static bool plain(const std::string& text) {
    return std::all_of(text.begin(), text.end(), [](unsigned char c) { return (c < 128 && std::isalnum(c)) || c == '_' || c == '-'; });
  }

  void duration() {
    const bool rest = p_.flow.kind == FlowKind::rest;
    std::string lengths;
    for (const char* name : {"run.strain", "run.duration", "run.steps"}) {
      if (!has(name)) continue;
      if (!lengths.empty()) fail(name, fmt::format("{} contradicts {}: give one of both", said(name), said(lengths)));
      lengths = name;
    }
    if (!rest) return;
    if (has("run.strain")) {
      fail("run.strain", fmt::format("{} has no meaning with flow.kind = \"rest\": give run.steps or run.duration instead", said("run.strain")));
    }
    if (lengths.empty()) fail("", "run.steps is missing: flow.kind = \"rest\" needs the length of the run in time steps, a whole number >= 1 (or run.duration)");
    // At rest there is no strain to count in: cadences have the unit of the length.
    if (p_.run.duration) {
      if (!has("output.series_every")) p_.output.series_every = *p_.run.duration / 200;
      if (!has("output.snapshot_every")) p_.output.snapshot_every = *p_.run.duration / 10;
      return;
    }
    const auto steps = static_cast<double>(*p_.run.steps);
    if (!has("output.series_every")) p_.output.series_every = std::max(1.0, std::floor(steps / 200));
    if (!has("output.snapshot_every")) p_.output.snapshot_every = std::max(1.0, std::floor(steps / 10));
    for (const char* key : {"output.series_every", "output.snapshot_every"}) {
      const double value = std::string_view(key) == "output.series_every" ? p_.output.series_every : p_.output.snapshot_every;
      if (value != std::floor(value)) fail(key, fmt::format("{} must be a whole number of time steps with flow.kind = \"rest\"", said(key)));
    }
  }

  /// With several steps between two couplings vertices move with one mean velocity of the fluid, whatever the update.
  void coupling() {
    if (p_.accuracy.coupling_every > 1 && p_.accuracy.vertex_update == VertexUpdate::euler && !p_.cells.empty())
      fail("accuracy.coupling_every", fmt::format("{} contradicts {}: vertices don't move with the velocity of the last step then; remove one of both", said("accuracy.coupling_every"),
                                                  said("accuracy.vertex_update")));
  }

  /// The merged scene has what the target chose, not the target.
  void target() {
    if (!p_.accuracy.target) return;
    const std::string said_target = said("accuracy.target");
    if (has("accuracy.radius") && has("accuracy.delta_kernel"))
      fail("accuracy.target", fmt::format("{} leaves nothing to choose with {} and {}: remove one of the three", said_target, said("accuracy.radius"), said("accuracy.delta_kernel")));
    if (has("accuracy.subdivision"))
      fail("accuracy.target", fmt::format("{} contradicts {}: errors were measured with the default mesh; remove one of both", said_target, said("accuracy.subdivision")));
    if (chooses_relaxation_time()) p_.accuracy.relaxation_time = studied_relaxation_time;
    const double wanted = *p_.accuracy.target;
    p_.accuracy.target.reset();
    try {
      choose_resolution(p_, wanted, has("accuracy.radius") ? std::optional(p_.accuracy.radius) : std::nullopt,
                        has("accuracy.delta_kernel") ? std::optional(p_.accuracy.delta_kernel) : std::nullopt);
    } catch (const InputError& error) {
      fail("accuracy.target", error.what());
    }
  }

  /// With BGK the shell of a cell depends on it: 1, as problem.hpp has it, where shells were measured.
  bool chooses_relaxation_time() const { return !has("accuracy.relaxation_time") && p_.accuracy.collision == CollisionKind::trt; }

  void relaxation_time() {
    if (chooses_relaxation_time()) p_.accuracy.relaxation_time = relaxation_time_of_fewest_steps(p_);
  }

  void files() {
    const auto readable = [&](const std::string& key, const std::string& file, const char* what) {
      std::error_code ignored;
      if (file.empty()) return;
      if (!std::filesystem::is_regular_file(file, ignored)) fail(key, fmt::format("{} = {}: there is no such file; it must be {}", key, quote(file), what));
    };
    for (std::size_t i = 0; i < p_.cells.size(); ++i) readable(fmt::format("cells.{}.file", i), p_.cells[i].file, "a closed mesh in OFF format");
    readable("run.packing", p_.run.packing, "a packing saved by an earlier run");
  }

  /// A key that has no effect in this scene is a mistake the user should hear of.
  void meaningless() {
    for (const auto& [path, place] : given_) {
      CellSpec none;
      CellSpec* owner = path.starts_with("cells.") ? &p_.cells.at(std::stoul(path.substr(6))) : &none;
      std::string reason;
      if (!applies(*find_key(pattern_of(path)), p_, *owner, reason)) {
        fail(path, fmt::format("{} has no effect here, it needs {}: remove it", said(path), reason));
      }
    }
  }

  Problem& p_;
  const Given& given_;
  const std::string& origin_;
};

}  // namespace

void finish_and_check(Problem& problem, const Given& given, const std::string& origin) { Checker(problem, given, origin).run(); }

}  // namespace corpuscle::scene
