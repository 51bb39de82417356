// OFF files: what is accepted, and one readable sentence for everything that is not.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/error.hpp"
#include "physics/mesh.hpp"
#include "tests/catch.hpp"
#include "tests/complaint.hpp"
#include "tests/scratch.hpp"

using namespace corpuscle;

namespace {

std::string off_text(const Mesh& mesh) {
  std::ostringstream out;
  out.precision(17);
  out << "OFF\n" << mesh.vertices.size() << ' ' << mesh.faces.size() << " 0\n";
  for (const Vector3& x : mesh.vertices) out << x.x() << ' ' << x.y() << ' ' << x.z() << '\n';
  for (const auto& f : mesh.faces) out << "3 " << f[0] << ' ' << f[1] << ' ' << f[2] << '\n';
  return out.str();
}

Mesh read_text(const std::string& text, double radius = 1) {
  const ScratchFolder folder;
  const std::string path = (folder / "cell.off").string();
  std::ofstream(path) << text;
  return read_off(path, radius);
}
Mesh reread(const Mesh& mesh, double radius = 1) { return read_text(off_text(mesh), radius); }

const std::string tetrahedron_vertices = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
const std::string tetrahedron_faces = "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

Mesh tetrahedron(const Vector3& shift = Vector3::Zero()) {
  Mesh mesh;
  mesh.vertices = {Vector3(0, 0, 0) + shift, Vector3(1, 0, 0) + shift, Vector3(0, 1, 0) + shift, Vector3(0, 0, 1) + shift};
  mesh.faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh;
}

void append(Mesh& mesh, const Mesh& other) {
  const int offset = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& f : other.faces) mesh.faces.push_back({f[0] + offset, f[1] + offset, f[2] + offset});
}

/// Grid of m x m squares closed to a torus.
Mesh torus(int m) {
  Mesh mesh;
  const double step = 2 * 3.14159265358979 / m;
  for (int i = 0; i < m; ++i)
    for (int j = 0; j < m; ++j) {
      const double rho = 2 + std::cos(j * step);
      mesh.vertices.emplace_back(rho * std::cos(i * step), rho * std::sin(i * step), std::sin(j * step));
    }
  const auto at = [m](int i, int j) { return (i % m) * m + j % m; };
  for (int i = 0; i < m; ++i)
    for (int j = 0; j < m; ++j) {
      mesh.faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

/// Cone over a regular polygon: its apex has `degree` neighbours.
Mesh double_cone(int degree) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 1}, {0, 0, -1}};
  for (int i = 0; i < degree; ++i) mesh.vertices.emplace_back(std::cos(6.283185307 * i / degree), std::sin(6.283185307 * i / degree), 0);
  for (int i = 0; i < degree; ++i) {
    const int a = 2 + i, b = 2 + (i + 1) % degree;
    mesh.faces.push_back({0, a, b});
    mesh.faces.push_back({1, b, a});
  }
  return mesh;
}

}  // namespace

TEST_CASE("read_off: round trip, scaled and centred", "[mesh][off]") {
  Mesh mesh = red_cell_mesh(1, 4);
  for (Vector3& x : mesh.vertices) x = 3 * x + Vector3(5, -6, 7);
  const Mesh read = reread(mesh, 9);
  CHECK(read.faces == mesh.faces);
  CHECK(mesh_centroid(read).norm() < 1e-12);
  double farthest = 0;
  for (const Vector3& x : read.vertices) farthest = std::max(farthest, x.norm());
  CHECK(farthest == Approx(9));
}

TEST_CASE("read_off: comments, counts on the first line, missing edge count, colours, Windows line ends", "[mesh][off]") {
  CHECK(read_text("# a cell\nOFF 4 4 # counts\r\n\n" + tetrahedron_vertices +
                  "# faces\n3 0 2 1  255 0 0\n3 0 1 3\r\n3 0 3 2\n3 1 2 3\n\n").faces.size() == 4);
  CHECK(read_text("OFF\n4 4\n0 0 0\n+1 0 0\n0 1e0 0\n0 0 .1E+1\n" + tetrahedron_faces).faces.size() == 4);
}

TEST_CASE("read_off: a surface that is inside out is turned", "[mesh][off]") {
  Mesh mesh = icosphere(2);
  for (auto& f : mesh.faces) std::swap(f[1], f[2]);
  CHECK(mesh_volume(mesh) < 0);
  CHECK(mesh_volume(reread(mesh)) > 0);
}

TEST_CASE("read_off: malformed files", "[mesh][off]") {
  CHECK(complaint_lacks([&] { read_off("no/such/file.off", 1); }, {"no/such/file.off", "no such file"}) == "");
  CHECK_THROWS_AS(read_off(std::filesystem::temp_directory_path().string(), 1), InputError);  // a directory
  CHECK(complaint_lacks([&] { read_text(""); }, {"the word OFF"}) == "");
  CHECK(complaint_lacks([&] { read_text("ply\n"); }, {"line 1", "'ply'", "must start with OFF"}) == "");
  CHECK(complaint_lacks([&] { read_text("COFF\n4 4 0\n"); }, {"must start with OFF"}) == "");
  CHECK(complaint_lacks([&] { read_text("OFF\n"); }, {"file ends after line 1"}) == "");
  CHECK(complaint_lacks([&] { read_text("OFF\nfour 4 0\n"); }, {"line 2", "number of vertices", "'four'"}) == "");
  CHECK(complaint_lacks([&] { read_text("OFF\n4\n"); }, {"number of faces", "line ends"}) == "");
  CHECK(complaint_lacks([&] { read_text("OFF\n-4 4 0\n"); }, {"-4 vertices"}) == "");
  CHECK(complaint_lacks([&] { read_text("OFF\n99999999999999999999 4 0\n"); }, {"number of vertices"}) == "");
  CHECK(complaint_lacks([&] { read_text("OFF\n4000000000 4 0\n"); }, {"correct the header"}) == "");
  CHECK(complaint_lacks([&] { read_text("OFF\n5 4 0\n" + tetrahedron_vertices); }, {"line 6", "vertex 4 of 5"}) == "");
  CHECK(complaint_lacks([&] { read_text("OFF\n4 4 0\n" + tetrahedron_vertices + "3 0 2 1\n"); }, {"line 7", "face 1 of 4"}) == "");
  CHECK(complaint_lacks([&] { read_text("OFF\n4 4 0\n0 0\n"); }, {"line 3", "coordinate", "line ends"}) == "");
  CHECK(complaint_lacks([&] { read_text("OFF\n4 4 0\n0 0 1,5\n"); }, {"'1,5'"}) == "");
  CHECK(complaint_lacks([&] { read_text("OFF\n4 4 0\n0 nan 0\n"); }, {"line 3", "finite"}) == "");
  CHECK(complaint_lacks([&] { read_text("OFF\n4 4 0\n0 0 inf\n"); }, {"finite"}) == "");
  const std::string head = "OFF\n4 4 0\n" + tetrahedron_vertices;
  CHECK(complaint_lacks([&] { read_text(head + "3 0 2 4\n"); }, {"line 7", "vertex 4", "0 to 3"}) == "");
  CHECK(complaint_lacks([&] { read_text(head + "3 0 -1 2\n"); }, {"vertex -1"}) == "");
  CHECK(complaint_lacks([&] { read_text(head + "3 0 1.5 2\n"); }, {"'1.5'"}) == "");
  CHECK(complaint_lacks([&] { read_text(head + "4 0 1 2 3\n"); }, {"4 corners", "triangulate"}) == "");
  CHECK(complaint_lacks([&] { read_text(head + tetrahedron_faces + "3 0 1 2\n"); }, {"line 11", "more than"}) == "");
  CHECK(complaint_lacks([&] { read_text(head + "3 0 2 1\n3 0 1 1\n3 0 3 2\n3 1 2 3\n"); }, {"face 1", "twice"}) == "");
  CHECK(complaint_lacks([&] { read_text("OFF\n5 4 0\n" + tetrahedron_vertices + "9 9 9\n" + tetrahedron_faces); }, {"vertex 4", "no face"}) == "");
  CHECK(complaint_lacks([&] { read_text(head + tetrahedron_faces, 0); }, {"radius", "positive"}) == "");
}

TEST_CASE("read_off: a file without line ends is not read as one line", "[mesh][off]") {
  CHECK(complaint_lacks([] { read_text(std::string(100'000, '0')); }, {"line 1", "longer than 8191 characters"}) == "");
  CHECK(complaint_lacks([] { read_text("OFF\n4 4 0\n" + tetrahedron_vertices + std::string(10'000, ' ') + tetrahedron_faces); }, {"line 7", "longer"}) == "");
  CHECK(read_text("OFF\n4 4 0 # " + std::string(8'000, 'x') + "\n" + tetrahedron_vertices + tetrahedron_faces).faces.size() == 4);
  CHECK(complaint_lacks([] { read_text("OFF\n4 4 0\n" + std::string("0 0\0 0\n", 8) + tetrahedron_faces); }, {"line 3", "coordinate"}) == "");
}

TEST_CASE("read_off: surfaces that are no cell", "[mesh][off]") {
  SECTION("open") {
    Mesh mesh = icosphere(2);
    mesh.faces.pop_back();
    CHECK(complaint_lacks([&] { reread(mesh); }, {"open", "edge between vertices"}) == "");
  }
  SECTION("edge with more than two faces") {
    Mesh mesh = tetrahedron();  // two tetrahedra with a common edge 0-1
    mesh.vertices.emplace_back(0, -1, 0);
    mesh.vertices.emplace_back(0, 0, -1);
    for (auto f : {std::array{0, 4, 1}, {0, 1, 5}, {0, 5, 4}, {1, 4, 5}}) mesh.faces.push_back(f);
    CHECK(complaint_lacks([&] { reread(mesh); }, {"vertices 0 and 1", "4 faces"}) == "");
  }
  SECTION("non-manifold vertex") {
    Mesh mesh = tetrahedron();
    append(mesh, tetrahedron(Vector3(2, 0, 0)));
    for (auto& f : mesh.faces)
      for (int& v : f) v = v == 4 ? 0 : v > 4 ? v - 1 : v;  // vertex 0 belongs to both
    mesh.vertices.erase(mesh.vertices.begin() + 4);
    CHECK(complaint_lacks([&] { reread(mesh); }, {"touch in vertex 0"}) == "");
  }
  SECTION("inconsistent orientation") {
    Mesh mesh = icosphere(2);
    std::swap(mesh.faces[7][0], mesh.faces[7][1]);
    CHECK(complaint_lacks([&] { reread(mesh); }, {"oriented against each other", "face"}) == "");
  }
  SECTION("several parts") {
    Mesh mesh = tetrahedron();
    append(mesh, tetrahedron(Vector3(3, 0, 0)));
    CHECK(complaint_lacks([&] { reread(mesh); }, {"2 separate parts"}) == "");
  }
  SECTION("handle") { CHECK(complaint_lacks([&] { reread(torus(8)); }, {"1 handle", "sphere"}) == ""); }
  SECTION("degenerate triangle") {
    Mesh mesh = tetrahedron();  // split edge 1-2 in its middle without opening it: two flat faces
    mesh.vertices.emplace_back(0.5, 0.5, 0);
    mesh.faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 4}, {2, 3, 4}, {3, 1, 4}};
    CHECK(complaint_lacks([&] { reread(mesh); }, {"face 3", "degenerate"}) == "");
  }
  SECTION("flat: no volume") {
    Mesh mesh = icosphere(3);
    for (Vector3& x : mesh.vertices) x.z() *= 1e-6;
    CHECK_THROWS_AS(reread(mesh), InputError);
  }
  SECTION("too many neighbours") {
    CHECK(reread(double_cone(12)).faces.size() == 24);
    CHECK(complaint_lacks([&] { reread(double_cone(13)); }, {"vertex 0", "13 neighbours", "12"}) == "");
  }
}
