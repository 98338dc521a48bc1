// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The Gauss points of a Membrane's cell, four at a time: where they are and how the sheet is deformed there.
#include <cmath>

#include "foreign_laboratory/sheet/membrane.h"

namespace formwright::foreign_laboratory {

namespace membrane_detail {

using Four = Eigen::Array4d;
using Vector4 = std::array<Four, 3>;

// From -1 to 1 in both directions, in the order of the cell's corners.
inline const double gauss = 1 / std::sqrt(3.0);
inline const Four low_x = 0.5 * (1 - Four(-gauss, gauss, gauss, -gauss)), high_x = 1 - low_x;
inline const Four low_y = 0.5 * (1 - Four(-gauss, -gauss, gauss, gauss)), high_y = 1 - low_y;
inline const std::array<Four, 4> corner_weight = {low_x * low_y, high_x* low_y, high_x* high_y, low_x* high_y};

}  // namespace membrane_detail

/// Deformation gradient (its two columns) and what follows from it.
struct Membrane::Shape {
  membrane_detail::Vector4 along_x, along_y, area;  // area: the cross product of the columns
  Four cxx, cxy, cyy, zz;                           // C; its component across the sheet, 1/det
  Tensor inverse;                                   // C^-1
  std::array<int, 4> corner;
  Four height;
};

inline Membrane::Shape Membrane::shape_of(int cell, const Points& x) const {
  using namespace membrane_detail;
  Shape s;
  s.corner = grid_.corners(cell);
  const double per_x = 1 / grid_.spacing_x_mm(), per_y = 1 / grid_.spacing_y_mm();
  const auto a = x.col(s.corner[0]), b = x.col(s.corner[1]), c = x.col(s.corner[2]), d = x.col(s.corner[3]);
  for (Eigen::Index k = 0; k < 3; ++k) {
    s.along_x[static_cast<std::size_t>(k)] = low_y * ((b[k] - a[k]) * per_x) + high_y * ((c[k] - d[k]) * per_x);
    s.along_y[static_cast<std::size_t>(k)] = low_x * ((d[k] - a[k]) * per_y) + high_x * ((c[k] - b[k]) * per_y);
  }
  s.cxx = s.along_x[0] * s.along_x[0] + s.along_x[1] * s.along_x[1] + s.along_x[2] * s.along_x[2];
  s.cxy = s.along_x[0] * s.along_y[0] + s.along_x[1] * s.along_y[1] + s.along_x[2] * s.along_y[2];
  s.cyy = s.along_y[0] * s.along_y[0] + s.along_y[1] * s.along_y[1] + s.along_y[2] * s.along_y[2];
  const Four determinant = s.cxx * s.cyy - s.cxy * s.cxy;
  s.zz = 1 / determinant;
  s.inverse = {s.cyy * s.zz, -s.cxy * s.zz, s.cxx * s.zz, determinant};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
    s.area[k] = s.along_x[next] * s.along_y[last] - s.along_x[last] * s.along_y[next];
  }
  s.height = a[2] * corner_weight[0] + b[2] * corner_weight[1] + c[2] * corner_weight[2] + d[2] * corner_weight[3];
  return s;
}

}  // namespace formwright::foreign_laboratory
