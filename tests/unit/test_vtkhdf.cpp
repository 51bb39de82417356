// Structure of the VTKHDF files as docs.vtk.org specifies it; that VTK reads them is tested in tests/integration/test_vtk_readback.py.
#include "io/vtkhdf.hpp"

#include "io/hdf5.hpp"
#include "physics/mesh.hpp"
#include "physics/statistics/volume_moments.hpp"
#include "tests/catch.hpp"
#include "tests/scratch.hpp"

using namespace corpuscle;
using Integers = std::vector<std::int64_t>;

namespace {

constexpr VtkDomain domain{.size = {20, 20, 30}, .periodic = {true, true, false}, .radius = 4};

struct Cells {
  Mesh coarse = sphere_mesh(4, 2);
  Mesh fine = sphere_mesh(3, 3);
  std::vector<VtkCellType> types() const {
    return {{"coarse", coarse.faces, static_cast<std::int64_t>(coarse.vertices.size()), 2},
            {"fine", fine.faces, static_cast<std::int64_t>(fine.vertices.size()), 1}};
  }
  std::size_t points() const { return 2 * coarse.vertices.size() + fine.vertices.size(); }
  std::size_t faces() const { return 2 * coarse.faces.size() + fine.faces.size(); }
  /// Spheres around the given centres; everything moves with 0.5 along x.
  Snapshot at(std::int64_t step, const std::array<Vector3, 3>& centres) const {
    Snapshot snapshot;
    snapshot.step = step;
    snapshot.strain = 0.01 * static_cast<double>(step);
    for (std::size_t cell = 0; cell < 3; ++cell) {
      for (const auto& vertex : cell < 2 ? coarse.vertices : fine.vertices) {
        const Vector3 x = centres[cell] + vertex;
        snapshot.positions.insert(snapshot.positions.end(), {x.x(), x.y(), x.z()});
        snapshot.velocities.insert(snapshot.velocities.end(), {0.5, 0, 0});
      }
    }
    return snapshot;
  }
};

const std::array<Vector3, 3> inside{Vector3(5, 5, 5), Vector3(15, 5, 15), Vector3(10, 15, 25)};

}  // namespace

TEST_CASE("VtkHdfPolyData: groups, counts and offsets of two steps", "[io]") {
  const ScratchFolder folder;
  const Cells cells;
  const auto path = folder / "cells.vtkhdf";
  VtkHdfPolyData writer(path, cells.types(), domain);
  CHECK(hdf5::File::open_for_reading(path).number_attribute("/VTKHDF/Steps", "NSteps") == 0);
  writer.append(cells.at(0, inside));
  writer.append(cells.at(100, inside));

  const auto file = hdf5::File::open_for_reading(path);
  const auto p = static_cast<std::int64_t>(cells.points());
  const auto f = static_cast<std::int64_t>(cells.faces());
  CHECK(file.numbers_attribute("/VTKHDF", "Version") == std::vector<double>{2, 0});
  CHECK(file.string_attribute("/VTKHDF", "Type") == "PolyData");
  CHECK(file.number_attribute("/VTKHDF/Steps", "NSteps") == 2);
  CHECK(file.read<double>("/VTKHDF/Steps/Values").values == std::vector<double>{0, 1});
  const auto integers = [&](const std::string& name) { return file.read<std::int64_t>("/VTKHDF/" + name).values; };
  CHECK(integers("NumberOfPoints") == Integers{p});
  CHECK(integers("Polygons/NumberOfCells") == Integers{f});
  CHECK(integers("Polygons/NumberOfConnectivityIds") == Integers{3 * f});
  for (const std::string empty : {"Vertices", "Lines", "Strips"}) {
    CHECK(integers(empty + "/NumberOfCells") == Integers{0});
    CHECK(integers(empty + "/NumberOfConnectivityIds") == Integers{0});
    CHECK(integers(empty + "/Offsets") == Integers{0});
    CHECK(integers(empty + "/Connectivity").empty());
  }
  CHECK(integers("Steps/PartOffsets") == Integers{0, 0});
  CHECK(integers("Steps/NumberOfParts") == Integers{1, 1});
  CHECK(integers("Steps/PointOffsets") == Integers{0, p});
  CHECK(file.shape("/VTKHDF/Steps/CellOffsets") == hdf5::Shape{2, 4});
  CHECK(integers("Steps/CellOffsets") == Integers(8, 0));
  CHECK(integers("Steps/ConnectivityIdOffsets") == Integers(8, 0));
  CHECK(integers("Steps/PointDataOffsets/velocity") == Integers{0, p});
  CHECK(integers("Steps/PointDataOffsets/deformation") == Integers{0, p});
  CHECK(integers("Steps/PointDataOffsets/cell_id") == Integers{0, 0});
  CHECK(integers("Steps/PointDataOffsets/type") == Integers{0, 0});

  CHECK(file.shape("/VTKHDF/Points") == hdf5::Shape{2 * cells.points(), 3});
  CHECK(file.shape("/VTKHDF/PointData/velocity") == hdf5::Shape{2 * cells.points(), 3});
  CHECK(file.shape("/VTKHDF/PointData/deformation") == hdf5::Shape{2 * cells.points()});
  const auto ids = integers("PointData/cell_id");
  const auto types = integers("PointData/type");
  REQUIRE(ids.size() == cells.points());
  CHECK((ids.front() == 0 && ids[cells.coarse.vertices.size()] == 1 && ids.back() == 2));
  CHECK((types.front() == 0 && types.back() == 1));

  // The topology is stored once, and each cell's faces use that cell's points only.
  const auto connectivity = integers("Polygons/Connectivity");
  const auto offsets = integers("Polygons/Offsets");
  REQUIRE(connectivity.size() == 3 * cells.faces());
  REQUIRE(offsets.size() == cells.faces() + 1);
  CHECK(offsets.back() == 3 * f);
  bool one_cell_each = true;
  for (std::size_t i = 0; i < connectivity.size(); i += 3) {
    const auto cell = [&](std::size_t k) { return ids[static_cast<std::size_t>(connectivity[k])]; };
    one_cell_each = one_cell_each && cell(i) == cell(i + 1) && cell(i) == cell(i + 2);
  }
  CHECK(one_cell_each);
}

TEST_CASE("VtkHdfPolyData: cells stay whole with their centre in the periodic box", "[io]") {
  const ScratchFolder folder;
  const Cells cells;
  VtkHdfPolyData writer(folder / "cells.vtkhdf", cells.types(), domain);
  // Unwrapped far along x and y; along z there are walls and nothing may be shifted.
  writer.append(cells.at(1, {Vector3(5 + 40, 5 - 60, 5), Vector3(19.5, 0.5, 15), Vector3(-0.5, 15, 31)}));
  const auto file = hdf5::File::open_for_reading(folder / "cells.vtkhdf");
  const auto stored = file.read<float>("/VTKHDF/Points").values;
  const std::vector<double> points(stored.begin(), stored.end());
  const std::size_t n = 3 * cells.coarse.vertices.size();
  const auto centre = [&](std::size_t first, const Mesh& mesh) {
    return statistics::volume_moments(std::span(points).subspan(first, 3 * mesh.vertices.size()), mesh.faces).centre;
  };
  const auto a = centre(0, cells.coarse);
  const auto b = centre(n, cells.coarse);
  const auto c = centre(2 * n, cells.fine);
  CHECK((a[0] == Approx(5) && a[1] == Approx(5) && a[2] == Approx(5)));
  CHECK((b[0] == Approx(19.5) && b[1] == Approx(0.5) && b[2] == Approx(15)));
  CHECK((c[0] == Approx(19.5) && c[1] == Approx(15) && c[2] == Approx(31)));
  for (const float d : file.read<float>("/VTKHDF/PointData/deformation").values) CHECK(d < 1e-4F);
}

TEST_CASE("VtkHdfPolyData: resuming drops later snapshots", "[io]") {
  const ScratchFolder folder;
  const Cells cells;
  const auto path = folder / "cells.vtkhdf";
  {
    VtkHdfPolyData writer(path, cells.types(), domain);
    for (int step = 0; step <= 300; step += 100) writer.append(cells.at(step, inside));
  }
  auto writer = VtkHdfPolyData::resume(path, cells.types(), domain, 150, 1.5);
  writer.append(cells.at(250, inside));
  const auto file = hdf5::File::open_for_reading(path);
  CHECK(file.number_attribute("/VTKHDF/Steps", "NSteps") == 3);
  CHECK(file.read<double>("/VTKHDF/Steps/Values").values == std::vector<double>{0, 1, 2.5});
  CHECK(file.shape("/VTKHDF/Points").at(0) == 3 * cells.points());
  CHECK(file.shape("/VTKHDF/Steps/CellOffsets").at(0) == 3);
}

TEST_CASE("VtkHdfPolyData: at rest the time axis is the step", "[io]") {
  const ScratchFolder folder;
  const Cells cells;
  auto at_rest = domain;
  at_rest.at_rest = true;
  VtkHdfPolyData writer(folder / "cells.vtkhdf", cells.types(), at_rest);
  auto snapshot = cells.at(500, inside);
  snapshot.strain = 0;
  writer.append(snapshot);
  CHECK(hdf5::File::open_for_reading(folder / "cells.vtkhdf").read<double>("/VTKHDF/Steps/Values").values == std::vector<double>{500});
  snapshot.velocities.pop_back();
  CHECK_THROWS_AS(writer.append(snapshot), std::logic_error);
}

TEST_CASE("VtkHdfImage: attributes, shape and order of the fluid's velocity", "[io]") {
  const ScratchFolder folder;
  const auto path = folder / "fluid.vtkhdf";
  const std::array<int, 3> nodes{4, 3, 2};
  Snapshot snapshot;
  snapshot.strain = 0.5;
  for (int i = 0; i < 4 * 3 * 2 * 3; ++i) snapshot.fluid_velocity.push_back(static_cast<float>(i));
  {
    VtkHdfImage writer(path, nodes, domain);
    writer.append(snapshot);
    snapshot.strain = 1;
    writer.append(snapshot);
    CHECK_THROWS_AS(writer.append(Snapshot{}), std::logic_error);
  }
  {
    const auto file = hdf5::File::open_for_reading(path);
    CHECK(file.string_attribute("/VTKHDF", "Type") == "ImageData");
    CHECK(file.numbers_attribute("/VTKHDF", "WholeExtent") == std::vector<double>{0, 3, 0, 2, 0, 1});
    CHECK(file.numbers_attribute("/VTKHDF", "Origin") == std::vector<double>{0.5, 0.5, 0.5});
    CHECK(file.shape("/VTKHDF/PointData/velocity") == hdf5::Shape{2, 2, 3, 4, 3});
    const auto velocity = file.read<float>("/VTKHDF/PointData/velocity").values;
    CHECK(std::equal(snapshot.fluid_velocity.begin(), snapshot.fluid_velocity.end(), velocity.begin() + 72));
    CHECK(file.read<std::int64_t>("/VTKHDF/Steps/PointDataOffsets/velocity").values == Integers{0, 1});
    CHECK(file.read<double>("/VTKHDF/Steps/Values").values == std::vector<double>{0.5, 1});
  }
  auto writer = VtkHdfImage::resume(path, nodes, domain, 15, 0.7);
  snapshot.strain = 0.8;
  writer.append(snapshot);
  CHECK(hdf5::File::open_for_reading(path).read<double>("/VTKHDF/Steps/Values").values == std::vector<double>{0.5, 0.8});
}
