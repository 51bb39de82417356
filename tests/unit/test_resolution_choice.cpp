// accuracy.target: the cheapest measured setting that is accurate enough, or a sentence that says what there is.
#include <fmt/format.h>

#include <algorithm>

#include "core/error.hpp"
#include "io/scene.hpp"
#include "physics/resolution_choice.hpp"
#include "tests/catch.hpp"

using namespace corpuscle;

namespace {

std::string scene(const std::string& accuracy, const std::string& cells = "effective_volume_fraction = 0.3") {
  return "[box]\nsize = [6, 6, 6]\n[flow]\ncapillary_number = 0.08\n[[cells]]\n" + cells + "\n[accuracy]\n" + accuracy;
}

Problem with(const std::string& accuracy, const std::string& cells = "effective_volume_fraction = 0.3") { return parse_scene(scene(accuracy, cells), "s.toml"); }

std::string refusal(const std::string& accuracy, const std::string& cells = "effective_volume_fraction = 0.3") {
  try {
    with(accuracy, cells);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

constexpr const char* drag = "\ncounted_shell = \"drag\"";
std::vector<ResolutionChoice> choices(const std::string& accuracy) { return resolution_choices(with("collision = \"trt\"\nrelaxation_time = 2.0" + accuracy)); }

}  // namespace

TEST_CASE("resolution choice: choices are in the order of their cost, and a front is what no cheaper one equals", "[resolution_choice]") {
  REQUIRE(choices(drag).size() > 8);
  REQUIRE(choices("").size() > 7);
  const auto all = choices(GENERATE(as<std::string>{}, drag, ""));
  for (std::size_t i = 1; i < all.size(); ++i) CHECK(all[i - 1].cost <= all[i].cost);
  const auto front = worthwhile(all);
  REQUIRE(!front.empty());
  CHECK(front.front().cost == all.front().cost);
  for (const auto& choice : all)
    CHECK(std::any_of(front.begin(), front.end(), [&](const auto& f) { return f.cost <= choice.cost && f.bound <= choice.bound; }));
  for (const auto& coarse : all)
    for (const auto& fine : all) {
      CHECK(fine.bound >= std::abs(fine.error.value) + fine.error.uncertainty);
      if (fine.delta_kernel == coarse.delta_kernel && fine.radius > coarse.radius) CHECK(coarse.bound >= fine.bound);
    }
  // Twice the radius at the same Reynolds number: 2^3 nodes and 2^2 steps.
  const auto cost = [&](double radius) { return std::find_if(all.begin(), all.end(), [&](const auto& c) { return c.radius == radius && c.delta_kernel == 2; })->cost; };
  CHECK(cost(8) / cost(4) > 20);
  CHECK(cost(8) / cost(4) < 45);
}

TEST_CASE("resolution choice: a target chooses the cheapest setting whose error is below it, and the merged scene has that", "[resolution_choice]") {
  const std::string shell = GENERATE(as<std::string>{}, drag, "");
  const auto all = choices(shell);
  for (const auto& choice : all) {
    const double target = choice.bound + 1e-9;
    if (target > 1) continue;
    const Problem problem = with(fmt::format("target = {}", target) + shell);
    const auto expected = std::find_if(all.begin(), all.end(), [&](const auto& c) { return c.bound <= target; });
    CAPTURE(target, choice.radius, choice.delta_kernel);
    CHECK(problem.accuracy.radius == expected->radius);
    CHECK(problem.accuracy.delta_kernel == expected->delta_kernel);
    CHECK(problem.accuracy.collision == CollisionKind::trt);
    CHECK(problem.accuracy.relaxation_time == relaxation_time_of_fewest_steps(problem));
    CHECK_FALSE(problem.accuracy.target);
    const ResolutionError error = viscosity_resolution_error(problem, to_lattice(problem));
    CHECK(std::abs(error.value) + error.uncertainty <= target);
  }
  const Problem problem = with("target = 0.5");
  CHECK(scene_differences(problem, parse_scene(to_toml(problem), "merged.toml"), "a", "b").empty());
}

TEST_CASE("resolution choice: what the scene gives beside the target is kept", "[resolution_choice]") {
  CHECK(with("target = 0.5\nradius = 6").accuracy.radius == 6);
  CHECK(with("target = 0.5\ndelta_kernel = 3").accuracy.delta_kernel == 3);
  const Problem bgk = with("target = 0.5\ncollision = \"bgk\"");
  CHECK(bgk.accuracy.collision == CollisionKind::bgk);
  CHECK(bgk.accuracy.relaxation_time == 1);
  const std::vector<std::string> set{"accuracy.target=0.5"};
  const Problem set_over = parse_scene(scene("radius = 12\ndelta_kernel = 4\nsubdivision = 9"), "s.toml", set);
  CHECK(set_over.accuracy.radius < 12);
  CHECK_FALSE(set_over.accuracy.subdivision);
}

TEST_CASE("resolution choice: what can't be promised is refused with what can", "[resolution_choice]") {
  const auto refused = [](const std::string& accuracy, const std::string& with_words, const std::string& cells = "effective_volume_fraction = 0.3") {
    const std::string message = refusal(accuracy, cells);
    CAPTURE(message);
    CHECK(message.find(with_words) != std::string::npos);
    CHECK(message.starts_with("s.toml:8: accuracy.target = "));
  };
  refused("target = 0.001", "beyond what was measured");
  refused("target = 0.001", "give at least");
  refused("target = 0.2\nradius = 6\ndelta_kernel = 2", "leaves nothing to choose");
  refused("target = 0.2\nradius = 7", "no study has accuracy.radius = 7");
  refused("target = 0.2\nsubdivision = 7", "contradicts accuracy.subdivision = 7");
  refused("target = 2", "out of range");
  refused("target = 0.2", "beyond the 0.449", "effective_volume_fraction = 0.8");
  const std::string spheres = refusal("target = 0.2", "shape = \"sphere\"\neffective_volume_fraction = 0.2");
  CHECK(spheres.find("red cells of one type") != std::string::npos);
}
