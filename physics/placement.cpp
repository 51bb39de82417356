#include "physics/placement.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/error.hpp"
#include "core/random.hpp"

namespace corpuscle {
namespace {

constexpr int trials_per_sphere = 100'000;

// One stream per purpose and cell: adding cells doesn't change the orientations of the others.
constexpr std::uint64_t centres_stream = 0, first_orientation_stream = 1;

/// Spheres sorted into grid cells not smaller than the largest diameter: neighbours are in the 27 cells around.
class SphereGrid {
 public:
  SphereGrid(const PlacementRequest& request, double largest_radius) : request_(request) {
    // Not many more cells than spheres, however small these are.
    const double per_axis = std::ceil(std::cbrt(static_cast<double>(request.radii.size()))) + 1;
    for (int a = 0; a < 3; ++a) count_[a] = static_cast<int>(std::clamp(std::floor(request.box[a] / (2 * largest_radius)), 1.0, 4 * per_axis));
    cells_.resize(static_cast<std::size_t>(count_[0]) * count_[1] * count_[2]);
  }

  bool is_free(const Vector3& centre, double radius) const {
    const std::array<int, 3> home = locate(centre);
    std::array<int, 3> first{}, last{};
    for (int a = 0; a < 3; ++a) {  // with fewer than 3 cells along an axis take each once
      const bool all = count_[a] < 3;
      first[a] = all ? 0 : home[a] - 1;
      last[a] = all ? count_[a] - 1 : home[a] + 1;
    }
    for (int k = first[2]; k <= last[2]; ++k)
      for (int j = first[1]; j <= last[1]; ++j)
        for (int i = first[0]; i <= last[0]; ++i)
          for (const Sphere& other : cells_[index({i, j, k})]) {
            const double reach = radius + other.radius;
            if (squared_distance(centre, other.centre) < reach * reach) return false;
          }
    return true;
  }

  void add(const Vector3& centre, double radius) { cells_[index(locate(centre))].push_back({centre, radius}); }

 private:
  struct Sphere {
    Vector3 centre;
    double radius;
  };

  std::array<int, 3> locate(const Vector3& x) const {
    std::array<int, 3> cell{};
    for (int a = 0; a < 3; ++a) cell[a] = std::clamp(static_cast<int>(x[a] / request_.box[a] * count_[a]), 0, count_[a] - 1);
    return cell;
  }
  std::size_t index(std::array<int, 3> cell) const {
    for (int a = 0; a < 3; ++a) cell[a] = (cell[a] + count_[a]) % count_[a];  // walls: the far side is visited in vain, without harm
    return (static_cast<std::size_t>(cell[2]) * count_[1] + cell[1]) * count_[0] + cell[0];
  }
  double squared_distance(const Vector3& a, const Vector3& b) const {
    Vector3 d = a - b;
    for (int axis = 0; axis < (request_.walls_z ? 2 : 3); ++axis) d[axis] -= request_.box[axis] * std::round(d[axis] / request_.box[axis]);
    return d.squaredNorm();
  }

  const PlacementRequest& request_;
  std::array<int, 3> count_{};
  std::vector<std::vector<Sphere>> cells_;
};

void validate(const PlacementRequest& request) {
  for (int a = 0; a < 3; ++a)
    if (!(std::isfinite(request.box[a]) && request.box[a] > 0))
      throw InputError("The box has the length " + std::to_string(request.box[a]) + " along one axis, but must be positive; correct box.size.");
  for (std::size_t c = 0; c < request.radii.size(); ++c) {
    const double radius = request.radii[c];
    if (!(std::isfinite(radius) && radius > 0))
      throw InputError("Cell " + std::to_string(c) + " has the radius " + std::to_string(radius) +
                       ", but it must be positive; correct its type in [[cells]].");
    for (int a = 0; a < 3; ++a) {
      const bool walls = a == 2 && request.walls_z;
      const double available = request.box[a] - (walls ? 2 * request.wall_gap : 0);
      if (2 * radius > available)
        throw InputError("Cell " + std::to_string(c) + " has a bounding sphere of diameter " + std::to_string(2 * radius) +
                         ", but the box leaves only " + std::to_string(available) + " lattice units along " + "xyz"[a] + "; enlarge box.size.");
    }
  }
}

double sphere_fraction(const PlacementRequest& request) {
  double volume = 0;
  for (const double radius : request.radii) volume += 4 * std::numbers::pi / 3 * radius * radius * radius;
  return volume / (request.box[0] * request.box[1] * request.box[2]);
}

}  // namespace

Placement place_spheres(const PlacementRequest& request) {
  validate(request);
  Placement placement;
  const std::size_t count = request.radii.size();
  if (count == 0) return placement;

  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return std::pair(-request.radii[a], a) < std::pair(-request.radii[b], b); });

  SphereGrid grid(request, request.radii[order.front()]);
  RandomStream random(request.seed, centres_stream);
  placement.centres.resize(count);
  for (std::size_t placed = 0; placed < count; ++placed) {
    const double radius = request.radii[order[placed]];
    const double margin = request.walls_z ? radius + request.wall_gap : 0;
    Vector3 centre;
    int trial = 0;
    do {
      if (trial++ == trials_per_sphere)
        throw InputError("Only " + std::to_string(placed) + " of " + std::to_string(count) +
                         " cells found a place: their bounding spheres would fill " + std::to_string(100 * sphere_fraction(request)) +
                         " % of the box, but random placement reaches about 30 %; start from smaller cells, fewer cells or a larger box.");
      const double x = random.uniform(0, request.box[0]), y = random.uniform(0, request.box[1]);  // separate: the order of draws is fixed
      centre = Vector3(x, y, random.uniform(margin, request.box[2] - margin));
    } while (!grid.is_free(centre, radius));
    grid.add(centre, radius);
    placement.centres[order[placed]] = centre;
  }
  for (std::size_t c = 0; c < count; ++c) {
    RandomStream own(request.seed, first_orientation_stream + c);
    placement.orientations.push_back(random_rotation(own));
  }
  return placement;
}

std::vector<double> place_mesh(const Mesh& mesh, const Vector3& centre, const UnitQuaternion& orientation, double scale) {
  const Eigen::Matrix3d rotation = Eigen::Quaterniond(orientation[0], orientation[1], orientation[2], orientation[3]).toRotationMatrix();
  std::vector<double> positions;
  positions.reserve(3 * mesh.vertices.size());
  for (const Vector3& x : mesh.vertices) {
    const Vector3 placed = centre + scale * (rotation * x);
    positions.insert(positions.end(), placed.data(), placed.data() + 3);
  }
  return positions;
}

double bounding_radius(const Mesh& mesh) {
  double largest = 0;
  for (const Vector3& x : mesh.vertices) largest = std::max(largest, x.norm());
  return largest;
}

}  // namespace corpuscle
