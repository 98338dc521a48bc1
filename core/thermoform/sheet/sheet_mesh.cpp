// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/sheet/sheet_mesh.h"

#include <algorithm>
#include <cmath>

namespace formwright {

SheetMesh make_sheet_mesh(const Vec2& opening_mm, int triangles) {
  const double cell_mm = std::sqrt(2 * opening_mm.x() * opening_mm.y() / std::max(triangles, 8));
  const auto even_cells = [&](double side_mm) {
    return std::max(2, 2 * static_cast<int>(std::lround(side_mm / (2 * cell_mm))));
  };
  const int nx = even_cells(opening_mm.x());
  int ny = even_cells(opening_mm.y());
  // Diagonals cross in the middle at every size, so that sheets of different fineness belong to one family.
  if ((nx / 2 + ny / 2) % 2 != 0) ny += 2;
  SheetMesh sheet;
  sheet.columns = nx + 1;
  sheet.rows = ny + 1;
  sheet.flat_mm.resize(static_cast<Eigen::Index>(sheet.columns) * sheet.rows, 2);
  sheet.clamped.reserve(static_cast<std::size_t>(sheet.columns) * static_cast<std::size_t>(sheet.rows));
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i <= nx; ++i) {
      // Written so that mirrored vertices have exactly opposite coordinates.
      sheet.flat_mm.row(static_cast<Eigen::Index>(j) * (nx + 1) + i) << (2 * i - nx) * (opening_mm.x() / (2 * nx)),
          (2 * j - ny) * (opening_mm.y() / (2 * ny));
      sheet.clamped.push_back(i == 0 || j == 0 || i == nx || j == ny);
    }
  sheet.F.resize(2 * static_cast<Eigen::Index>(nx) * ny, 3);
  Eigen::Index face = 0;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const int a = j * (nx + 1) + i, b = a + 1, c = a + nx + 1, d = c + 1;
      if ((i + j) % 2 == 0) {
        sheet.F.row(face++) << a, b, d;
        sheet.F.row(face++) << a, d, c;
      } else {
        sheet.F.row(face++) << a, b, c;
        sheet.F.row(face++) << b, d, c;
      }
    }
  return sheet;
}

}  // namespace formwright
