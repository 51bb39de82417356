// Written by report/resolution_table.py from docs/accuracy/phi20.json and docs/accuracy/phi45.json: do not change by hand.
#include "physics/resolution_error.hpp"

namespace corpuscle {

std::span<const MeasuredDeviation> measured_deviations() {
  using enum CountedBy;
  // phi, counted by, points of the kernel, r, deviation, uncertainty
  static constexpr MeasuredDeviation table[] = {
      {0.2, effective, 2, 3, 0.0761, 0.0633},
      {0.2, effective, 2, 4, 0.0496, 0.0611},
      {0.2, effective, 2, 5, 0.0704, 0.0621},
      {0.2, effective, 2, 6, 0.0367, 0.0603},
      {0.2, effective, 2, 8, 0.0456, 0.0607},
      {0.2, effective, 3, 3, 0.0882, 0.0646},
      {0.2, effective, 3, 4, 0.0941, 0.0641},
      {0.2, effective, 3, 5, 0.0605, 0.0620},
      {0.2, effective, 3, 6, 0.0534, 0.0611},
      {0.2, effective, 3, 8, 0.0642, 0.0618},
      {0.2, effective, 4, 3, 0.0535, 0.0611},
      {0.2, effective, 4, 4, 0.1102, 0.0654},
      {0.2, effective, 4, 5, 0.1503, 0.0721},
      {0.2, effective, 4, 6, 0.0782, 0.0625},
      {0.2, effective, 4, 8, 0.0884, 0.0653},
      {0.2, hydrodynamic, 2, 6, 0.0775, 0.0627},
      {0.2, hydrodynamic, 2, 8, 0.0515, 0.0612},
      {0.2, hydrodynamic, 3, 8, 0.0844, 0.0632},
      {0.2, mesh, 2, 3, 0.5401, 0.0972},
      {0.2, mesh, 2, 4, 0.3693, 0.0825},
      {0.2, mesh, 2, 5, 0.2875, 0.0756},
      {0.2, mesh, 2, 6, 0.2348, 0.0723},
      {0.2, mesh, 2, 8, 0.1383, 0.0686},
      {0.2, mesh, 3, 3, 0.7491, 0.1057},
      {0.2, mesh, 3, 4, 0.5338, 0.0898},
      {0.2, mesh, 3, 5, 0.3949, 0.0831},
      {0.2, mesh, 3, 6, 0.3084, 0.0767},
      {0.2, mesh, 3, 8, 0.1902, 0.0702},
      {0.2, mesh, 4, 4, 0.9574, 0.1206},
      {0.2, mesh, 4, 5, 0.6717, 0.1032},
      {0.2, mesh, 4, 6, 0.4821, 0.0874},
      {0.2, mesh, 4, 8, 0.3271, 0.0801},
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
