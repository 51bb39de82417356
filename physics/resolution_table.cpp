// Written by report/resolution_table.py from docs/accuracy/phi20.json and docs/accuracy/phi45.json: do not change by hand.
#include "physics/resolution_error.hpp"

namespace corpuscle {

std::span<const MeasuredDeviation> measured_deviations() {
  using enum CountedBy;
  // phi, counted by, points of the kernel, r, deviation, uncertainty
  static constexpr MeasuredDeviation table[] = {
      {0.2, effective, 2, 3, 0.1103, 0.0415},
      {0.2, effective, 2, 4, 0.0801, 0.0394},
      {0.2, effective, 2, 5, 0.0961, 0.0398},
      {0.2, effective, 2, 6, 0.0611, 0.0386},
      {0.2, effective, 3, 3, 0.1227, 0.0428},
      {0.2, effective, 3, 4, 0.1143, 0.0405},
      {0.2, effective, 3, 5, 0.0782, 0.0398},
      {0.2, effective, 3, 6, 0.0881, 0.0403},
      {0.2, effective, 4, 3, 0.0870, 0.0391},
      {0.2, effective, 4, 4, 0.1455, 0.0429},
      {0.2, effective, 4, 5, 0.1868, 0.0512},
      {0.2, effective, 4, 6, 0.1124, 0.0400},
      {0.2, hydrodynamic, 2, 6, 0.1118, 0.0404},
      {0.2, mesh, 2, 3, 0.5891, 0.0696},
      {0.2, mesh, 2, 4, 0.4128, 0.0558},
      {0.2, mesh, 2, 5, 0.3284, 0.0493},
      {0.2, mesh, 2, 6, 0.2740, 0.0471},
      {0.2, mesh, 3, 3, 0.8047, 0.0718},
      {0.2, mesh, 3, 4, 0.5826, 0.0584},
      {0.2, mesh, 3, 5, 0.4393, 0.0554},
      {0.2, mesh, 3, 6, 0.3500, 0.0499},
      {0.2, mesh, 4, 4, 1.0197, 0.0839},
      {0.2, mesh, 4, 5, 0.7248, 0.0720},
      {0.2, mesh, 4, 6, 0.5292, 0.0575},
      {0.449, effective, 2, 3, -0.1416, 0.0582},
      {0.449, effective, 2, 4, -0.0935, 0.0616},
      {0.449, effective, 2, 5, -0.1020, 0.0619},
      {0.449, effective, 2, 6, -0.1451, 0.0584},
      {0.449, effective, 3, 3, -0.1494, 0.0620},
      {0.449, effective, 3, 4, -0.1006, 0.0621},
      {0.449, effective, 3, 5, -0.0637, 0.0638},
      {0.449, effective, 3, 6, -0.0914, 0.0702},
      {0.449, effective, 4, 4, 0.0388, 0.0782},
      {0.449, effective, 4, 5, 0.0118, 0.0786},
      {0.449, effective, 4, 6, -0.0043, 0.0719},
      {0.449, hydrodynamic, 2, 6, -0.0633, 0.0647},
      {0.449, mesh, 2, 4, 0.7632, 0.1203},
      {0.449, mesh, 2, 5, 0.4956, 0.1006},
      {0.449, mesh, 2, 6, 0.3659, 0.0977},
      {0.449, mesh, 3, 5, 1.0036, 0.1363},
      {0.449, mesh, 3, 6, 0.7759, 0.1327},
  };
  return table;
}

}  // namespace corpuscle
