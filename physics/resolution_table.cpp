// Written by report/resolution_table.py from docs/accuracy/phi20.json and docs/accuracy/phi45.json: do not change by hand.
#include "physics/resolution_error.hpp"

namespace corpuscle {

std::span<const MeasuredDeviation> measured_deviations() {
  using enum CountedBy;
  // phi, counted by, points of the kernel, r, deviation, uncertainty
  static constexpr MeasuredDeviation table[] = {
      {0.2, effective, 2, 3, 0.0881, 0.0245},
      {0.2, effective, 2, 4, 0.0997, 0.0232},
      {0.2, effective, 2, 5, 0.0835, 0.0222},
      {0.2, effective, 2, 6, 0.0828, 0.0226},
      {0.2, effective, 2, 8, 0.0579, 0.0217},
      {0.2, effective, 3, 3, 0.1268, 0.0270},
      {0.2, effective, 3, 4, 0.1310, 0.0248},
      {0.2, effective, 3, 5, 0.1133, 0.0243},
      {0.2, effective, 3, 6, 0.1030, 0.0225},
      {0.2, effective, 3, 8, 0.0842, 0.0222},
      {0.2, effective, 3, 12, 0.0676, 0.0220},
      {0.2, effective, 4, 3, 0.0779, 0.0219},
      {0.2, effective, 4, 4, 0.1505, 0.0264},
      {0.2, effective, 4, 5, 0.1640, 0.0360},
      {0.2, effective, 4, 6, 0.1030, 0.0224},
      {0.2, effective, 4, 8, 0.0971, 0.0276},
      {0.2, hydrodynamic, 2, 6, 0.1194, 0.0235},
      {0.2, hydrodynamic, 2, 8, 0.0879, 0.0228},
      {0.2, hydrodynamic, 3, 8, 0.1224, 0.0237},
      {0.2, mesh, 2, 3, 0.6695, 0.0550},
      {0.2, mesh, 2, 4, 0.4479, 0.0382},
      {0.2, mesh, 2, 5, 0.3475, 0.0301},
      {0.2, mesh, 2, 6, 0.2855, 0.0283},
      {0.2, mesh, 2, 8, 0.1788, 0.0309},
      {0.2, mesh, 3, 3, 0.9047, 0.0512},
      {0.2, mesh, 3, 4, 0.6265, 0.0358},
      {0.2, mesh, 3, 5, 0.4621, 0.0361},
      {0.2, mesh, 3, 6, 0.3633, 0.0302},
      {0.2, mesh, 3, 8, 0.2332, 0.0284},
      {0.2, mesh, 4, 4, 1.0861, 0.0613},
      {0.2, mesh, 4, 5, 0.7573, 0.0520},
      {0.2, mesh, 4, 6, 0.5468, 0.0358},
      {0.2, mesh, 4, 8, 0.3765, 0.0364},
      {0.449, effective, 2, 3, -0.0173, 0.0763},
      {0.449, effective, 2, 4, 0.0304, 0.0799},
      {0.449, effective, 2, 5, 0.0128, 0.0783},
      {0.449, effective, 2, 6, -0.0207, 0.0757},
      {0.449, effective, 2, 8, -0.0382, 0.0766},
      {0.449, effective, 3, 3, -0.0263, 0.0799},
      {0.449, effective, 3, 4, 0.0454, 0.0811},
      {0.449, effective, 3, 5, 0.0562, 0.0827},
      {0.449, effective, 3, 6, 0.0385, 0.0828},
      {0.449, effective, 3, 8, 0.0506, 0.0824},
      {0.449, effective, 4, 4, 0.1891, 0.1002},
      {0.449, effective, 4, 5, 0.1582, 0.1001},
      {0.449, effective, 4, 6, 0.1398, 0.0930},
      {0.449, effective, 4, 8, 0.1333, 0.0900},
      {0.449, hydrodynamic, 2, 6, 0.0723, 0.0844},
      {0.449, hydrodynamic, 2, 8, 0.0259, 0.0797},
      {0.449, hydrodynamic, 3, 8, 0.0821, 0.0850},
      {0.449, mesh, 2, 4, 1.0184, 0.1574},
      {0.449, mesh, 2, 5, 0.7121, 0.1322},
      {0.449, mesh, 2, 6, 0.5636, 0.1266},
      {0.449, mesh, 3, 5, 1.2936, 0.1785},
      {0.449, mesh, 3, 6, 1.0329, 0.1703},
      {0.449, mesh, 4, 8, 1.2478, 0.1748},
  };
  return table;
}

}  // namespace corpuscle
