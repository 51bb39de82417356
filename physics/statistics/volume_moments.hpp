// Volume, centre and second moments of the space that a closed triangulated surface encloses.
#pragma once
#include <array>
#include <span>

namespace corpuscle::statistics {

struct VolumeMoments {
  double volume = 0;
  std::array<double, 3> centre{};
  std::array<double, 6> gyration{};  ///< second moment / volume about the centre: xx yy zz xy xz yz, as in CellSample
};

/// `positions` [vertices][3], `faces` outward triangles of vertex numbers below positions.size()/3; any unit of length.
VolumeMoments volume_moments(std::span<const double> positions, std::span<const std::array<int, 3>> faces);

}  // namespace corpuscle::statistics
