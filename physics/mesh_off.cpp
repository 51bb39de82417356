// Object File Format: "OFF", then "vertices faces edges", then one line per vertex (x y z) and per face (3 a b c); '#' starts a comment.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "core/error.hpp"
#include "physics/mesh.hpp"
#include "physics/mesh_check.hpp"

namespace corpuscle {
namespace {

/// Lines of words; knows where it is for error messages.
class OffReader {
 public:
  explicit OffReader(const std::string& path) : path_(path) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored))
      throw InputError("Mesh file '" + path + "': there is no such file; give the path of an OFF file relative to the scene.");
    file_.open(path);
    if (!file_) throw InputError("Mesh file '" + path + "' can't be opened; check its permissions.");
  }

  /// Moves to the next line with content. `expected` completes "the file ends ...".
  void next_line(const std::string& expected) {
    if (!try_next_line())
      throw InputError(source() + ": the file ends after line " + std::to_string(line_number_) + " where " + expected +
                       " should follow; check that it is complete and that the counts in its header are right.");
  }
  bool try_next_line() {
    while (file_.getline(buffer_.data(), static_cast<std::streamsize>(buffer_.size())) || file_.gcount() > 0) {
      ++line_number_;
      line_.assign(buffer_.data(), static_cast<std::size_t>(file_.gcount() - (file_.good() ? 1 : 0)));  // counts the line's end, if there is one
      if (file_.fail()) fail("the line is longer than " + std::to_string(buffer_.size() - 1) + " characters; write one vertex or face a line.");
      rest_ = std::string_view(line_).substr(0, line_.find('#'));
      if (!at_end_of_line()) return true;
    }
    return false;
  }
  bool at_end_of_line() { return rest_.find_first_not_of(blanks) == std::string_view::npos; }

  std::string_view word() {
    const auto begin = rest_.find_first_not_of(blanks);
    if (begin == std::string_view::npos) return {};
    const auto end = std::min(rest_.find_first_of(blanks, begin), rest_.size());
    const auto result = rest_.substr(begin, end - begin);
    rest_.remove_prefix(end);
    return result;
  }
  /// A number; independent of the locale. `what` says what is read, for the message.
  template <class Number>
  Number number(const char* what) {
    const std::string_view text = word();
    Number value{};
    const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
    const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
    if (text.empty() || error != std::errc{} || end != text.data() + text.size())
      fail(std::string("expected ") + what + (text.empty() ? " but the line ends" : " instead of '" + std::string(text.substr(0, 40)) + "'") +
           "; correct the line.");
    return value;
  }

  [[noreturn]] void fail(const std::string& message) const {
    throw InputError(source() + ", line " + std::to_string(line_number_) + ": " + message);
  }
  std::string source() const { return "Mesh file '" + path_ + "'"; }

 private:
  static constexpr const char* blanks = " \t\r\v\f";
  std::string path_, line_;
  std::array<char, 8192> buffer_{};  // a file without line ends must not be read as one line of gigabytes
  std::ifstream file_;
  std::string_view rest_;
  long line_number_ = 0;
};

struct Counts {
  long vertices, faces;
};

Counts read_header(OffReader& reader) {
  reader.next_line("the word OFF");
  const std::string magic(reader.word());
  if (magic != "OFF")
    reader.fail("the file starts with '" + magic.substr(0, 40) + "' but must start with OFF; save the mesh in the plain text Object File Format.");
  if (reader.at_end_of_line()) reader.next_line("the numbers of vertices and faces");
  Counts counts{};
  counts.vertices = reader.number<long>("the number of vertices");
  counts.faces = reader.number<long>("the number of faces");  // a number of edges may follow; nobody needs it
  constexpr long largest = 100'000'000;
  if (counts.vertices < 4 || counts.faces < 4 || counts.vertices > largest || counts.faces > largest)
    reader.fail("the header announces " + std::to_string(counts.vertices) + " vertices and " + std::to_string(counts.faces) +
                " faces, but a closed surface has at least 4 of each (and at most " + std::to_string(largest) + "); correct the header.");
  return counts;
}

Vector3 read_vertex(OffReader& reader) {
  Vector3 x;
  for (int a = 0; a < 3; ++a) x[a] = reader.number<double>("a coordinate");
  if (!x.allFinite()) reader.fail("a coordinate is not a finite number; correct it.");
  return x;
}

std::array<int, 3> read_face(OffReader& reader, long vertex_count) {
  const long corners = reader.number<long>("the number of corners of a face");
  if (corners != 3)
    reader.fail("a face has " + std::to_string(corners) + " corners, but only triangles are possible; triangulate the mesh.");
  std::array<int, 3> face{};
  for (int& v : face) {
    const long index = reader.number<long>("the index of a vertex");
    if (index < 0 || index >= vertex_count)
      reader.fail("a face names vertex " + std::to_string(index) + ", but vertices are counted from 0 to " + std::to_string(vertex_count - 1) +
                  "; correct the index.");
    v = static_cast<int>(index);
  }
  return face;  // colours may follow
}

/// Centroid to the origin, farthest vertex to the distance `radius`.
void normalise(Mesh& mesh, double radius) {
  const Vector3 centroid = mesh_centroid(mesh);
  double farthest = 0;
  for (Vector3& x : mesh.vertices) {
    x -= centroid;
    farthest = std::max(farthest, x.norm());
  }
  for (Vector3& x : mesh.vertices) x *= radius / farthest;
}

}  // namespace

Mesh read_off(const std::string& path, double radius) {
  if (!(std::isfinite(radius) && radius > 0))
    throw InputError("The radius of the cell in '" + path + "' is " + std::to_string(radius) +
                     ", but must be a positive number; correct it in [[cells]].");
  OffReader reader(path);
  const Counts counts = read_header(reader);
  Mesh mesh;  // grows while reading: a wrong count in the header must not allocate memory
  for (long v = 0; v < counts.vertices; ++v) {
    reader.next_line("vertex " + std::to_string(v) + " of " + std::to_string(counts.vertices));
    mesh.vertices.push_back(read_vertex(reader));
  }
  for (long f = 0; f < counts.faces; ++f) {
    reader.next_line("face " + std::to_string(f) + " of " + std::to_string(counts.faces));
    mesh.faces.push_back(read_face(reader, counts.vertices));
  }
  if (reader.try_next_line())
    reader.fail("there is more than the " + std::to_string(counts.vertices) + " vertices and " + std::to_string(counts.faces) +
                " faces that the header announces; correct the header.");
  require_cell_surface(mesh, reader.source());
  normalise(mesh, radius);
  return mesh;
}

}  // namespace corpuscle
