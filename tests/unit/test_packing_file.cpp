// A packing comes back as it was saved, and one that doesn't fit the scene is refused with the difference named.
#include <fstream>

#include "core/error.hpp"
#include "io/packing_file.hpp"
#include "tests/catch.hpp"
#include "tests/contains.hpp"
#include "tests/scratch.hpp"

using namespace corpuscle;

namespace {

Packing example() {
  Packing packing{.box = {24, 24, 36}, .types = {{"red_cell", 4, 3, 2}, {"bead", 2, 2, 1}}, .positions = {}};
  for (int i = 0; i < 3 * (2 * 3 + 2); ++i) packing.positions.push_back(0.1 * i);
  return packing;
}

}  // namespace

TEST_CASE("packing: saved and loaded", "[io]") {
  const ScratchFolder folder;
  save_packing(folder / "packing.h5", example());
  CHECK_FALSE(std::filesystem::exists(folder / "packing.h5.tmp"));
  auto layout = example();
  layout.positions.clear();
  CHECK(load_packing(folder / "packing.h5", layout).positions == example().positions);
  auto wrong = example();
  wrong.positions.pop_back();
  CHECK_THROWS_AS(save_packing(folder / "packing.h5", wrong), std::logic_error);
  CHECK_THROWS_AS(save_packing(folder / "missing/packing.h5", example()), OutputError);
}

TEST_CASE("packing: the layout follows from the lattice parameters", "[io]") {
  LatticeParameters lattice;
  lattice.nodes = {24, 24, 36};
  lattice.cells.resize(1);
  lattice.cells[0].name = "red_cell";
  const auto layout = packing_layout(lattice);
  CHECK(layout.box == std::array<double, 3>{24, 24, 36});
  REQUIRE(layout.types.size() == 1);
  CHECK(layout.types[0].name == "red_cell");
}

TEST_CASE("packing: what differs is named", "[io]") {
  const ScratchFolder folder;
  const auto path = folder / "packing.h5";
  save_packing(path, example());
  const auto refused = [&](auto change, const std::string& what) {
    auto expected = example();
    change(expected);
    CHECK_THROWS_AS(load_packing(path, expected), InputError);
    CHECK_THROWS_WITH(load_packing(path, expected), Contains("run.packing") && Contains(what));
  };
  refused([](Packing& p) { p.box[2] = 40; }, "box length along z (lattice nodes) is 36 in the packing and 40 in the scene");
  refused([](Packing& p) { p.types[0].count = 5; }, "number of cells of cell type 'red_cell' is 2 in the packing and 5");
  refused([](Packing& p) { p.types[1].vertices = 7; }, "vertices per cell of cell type 'bead' is 2 in the packing and 7");
  refused([](Packing& p) { p.types[1].radius = 2.5; }, "radius (lattice units) of cell type 'bead' is 2 in the packing and 2.5");
  refused([](Packing& p) { p.types[0].name = "disc"; }, "name of cell type 1 is red_cell in the packing and disc");
  refused([](Packing& p) { p.types.pop_back(); }, "number of cell types is 2 in the packing and 1");

  std::ofstream(folder / "text.h5") << "no";
  CHECK_THROWS_AS(load_packing(folder / "text.h5", example()), InputError);
  CHECK_THROWS_WITH(load_packing(folder / "none.h5", example()), Contains("none.h5") && Contains("No such file"));
}
