// Every model that a scene can leave out costs nothing then: none of its kernels is launched, none of its arrays is there, and all others are exactly the same.
#include "perf/optional_models.hpp"

#include <cstdlib>
#include <map>
#include <set>
#include <string>

#include "core/kernel_log.hpp"
#include "physics/live_statistics.hpp"
#include "physics/memory.hpp"
#include "physics/packing.hpp"
#include "physics/suspension.hpp"
#include "tests/catch.hpp"

using namespace corpuscle;
using perf::begins_with_any;

namespace {

struct Footprint {
  std::map<std::string, int> launches;  ///< of a step, after the first ones
  KernelLog::Bytes bytes;
};

Problem changed(const std::function<void(Problem&)>& change) {
  Problem problem = perf::usual_scene(4, 4, 0.25);
  change(problem);
  return problem;
}

Footprint footprint(const Problem& problem) {
  const LatticeParameters lattice = to_lattice(problem);
  const auto types = make_cell_types(problem, lattice);
  const auto positions = place_cells(problem, lattice, types);
  KernelLog log;
  const auto suspension = make_suspension(problem, lattice, types, positions);
  for (int i = 0; i < 3; ++i) suspension->step();
  const auto live = log.live();
  log.clear();
  suspension->step();
  return {log.counts(), live};
}

/// Without what comes and goes: searches for neighbours depend on how far vertices have moved.
void forget_searches(Footprint& f) {
  std::erase_if(f.launches, [](const auto& entry) { return begins_with_any(entry.first, {"contact", "bin_"}) && entry.first != "contact_forces"; });
  f.bytes.erase("contact_list");
}

std::string without_term(std::string label, const std::string& term) {
  const auto at = label.find(term);
  return at == std::string::npos ? label : label.erase(at, term.size());
}

}  // namespace

TEST_CASE("A model that a scene leaves out launches no kernel and allocates no byte", "[cost]") {
  for (const auto& model : perf::optional_models()) {
    INFO(model.name);
    Footprint with = footprint(changed(model.with)), without = footprint(changed(model.without));
    // The model is seen where it's used, and not at all where it isn't.
    for (const auto& beginning : model.kernels) {
      if (beginning == "bin_" || beginning == "mobility_" || beginning == "smooth_forces" || beginning == "vertex_motion") continue;  // rare, or only with several stages
      if (!runs_on_host && (beginning == "sort_")) continue;
      INFO(beginning);
      const auto uses = [&](const Footprint& f) {
        int sum = 0;
        for (const auto& [label, count] : f.launches)
          if (begins_with_any(label, {beginning}) || (beginning[0] == ',' && label.find(beginning) != std::string::npos)) sum += count;
        return sum;
      };
      CHECK(uses(with) > 0);
      CHECK(uses(without) == 0);
    }
    std::int64_t held = 0;
    for (const auto& [label, bytes] : with.bytes) held += begins_with_any(label, model.arrays) ? bytes : 0;
    CHECK((held > 0) == !model.arrays.empty());
    for (const auto& [label, bytes] : without.bytes) {
      INFO(label);
      CHECK(!begins_with_any(label, model.arrays));
    }

    // Everything else is the same.
    forget_searches(with);
    forget_searches(without);
    std::map<std::string, int> rest;
    for (const auto& [label, count] : with.launches) {
      std::string name = label;
      for (const auto& kernel : model.kernels)
        if (kernel[0] == ',') name = without_term(name, kernel);
      if (!begins_with_any(name, model.kernels) && !begins_with_any(name, model.shared)) rest[name] = count;
    }
    std::erase_if(without.launches, [&](const auto& entry) { return begins_with_any(entry.first, model.shared); });
    CHECK(rest == without.launches);
    std::erase_if(with.bytes, [&](const auto& entry) { return begins_with_any(entry.first, model.arrays); });
    if (model.name == "membrane in double precision")  // half as large in single precision
      for (const char* table : {"membrane_face_reference", "membrane_edge_reference"}) {
        CHECK(std::abs(with.bytes.at(table) - 2 * without.bytes.at(table)) <= 16);
        with.bytes.erase(table), without.bytes.erase(table);
      }
    CHECK(with.bytes == without.bytes);
  }
}

TEST_CASE("Guards, samples and snapshots of the fluid launch their kernels when they are asked for, and keep nothing for it", "[cost]") {
  const Problem problem = changed([](Problem&) {});
  const LatticeParameters lattice = to_lattice(problem);
  const auto types = make_cell_types(problem, lattice);
  const auto suspension = make_suspension(problem, lattice, types, place_cells(problem, lattice, types));
  for (int i = 0; i < 3; ++i) suspension->step();
  KernelLog log;
  const auto launched = [&](const auto& act) {
    log.clear();
    act();
    std::set<std::string> labels;
    for (const auto& launch : log.launches()) labels.insert(launch.label);
    // Searches for neighbours come when they are due; filling an array is no kernel of ours; populations cross the periodic sides before they are looked at.
    std::erase_if(labels, [](const std::string& label) { return begins_with_any(label, {"contact_", "bin_", "Kokkos::", "exchange_populations"}) && label != "contact_forces"; });
    CHECK(log.live() == KernelLog::Bytes{});
    return labels;
  };
  const auto step = launched([&] { suspension->step(); });
  for (const std::string& label : step) CHECK(!begins_with_any(label, {"guard", "sample", "velocity_max", "velocity_out"}));
  CHECK(launched([&] { suspension->check(); }) == std::set<std::string>{"guard_cells", "guard_nodes"});
  std::set<std::string> sample = launched([&] { suspension->step_and_measure(); });
  for (const std::string& label : step) CHECK(sample.erase(label) == 1);
  for (const char* label : {"sample_membrane_stress", "sample_contact_stress", "sample_shape", "velocity_max"}) {
    INFO(label);
    CHECK((sample.erase(label) == 1 || std::string(label) == "sample_contact_stress"));
  }
  for (const std::string& label : sample) CHECK(label.find("wall") != std::string::npos);  // stress at the walls
  CHECK(launched([&] { suspension->snapshot(false); }).empty());
  CHECK(launched([&] { suspension->snapshot(true); }) == std::set<std::string>{"velocity_out"});
}

TEST_CASE("Statistics that a scene doesn't ask for are in no prediction, snapshots neither", "[cost]") {
  const auto predicted = [](const std::function<void(Problem&)>& change) {
    const Problem problem = changed(change);
    return predict_memory(problem, to_lattice(problem));
  };
  const MemoryEstimate usual = predicted([](Problem&) {});
  CHECK(usual.statistics == 0);
  CHECK(predicted([](Problem& p) { p.output.statistics = true; }).statistics > 0);
  CHECK(predicted([](Problem& p) { p.output.fluid = true; }).output > usual.output);
}
