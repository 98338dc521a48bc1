// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/height_map.h"

#include <algorithm>
#include <cmath>

namespace formwright {

HeightMap make_height_map(const Positions& moved, const Triangles& F, double size_mm, PlateSize plate, double pixel_mm,
                          double top_mm, Context& context) {
  HeightMap map;
  const double nodes_x = std::ceil(plate.width_mm / pixel_mm - 1e-9) + 1,
               nodes_y = std::ceil(plate.height_mm / pixel_mm - 1e-9) + 1;
  if (nodes_x * nodes_y > 64e6)
    throw Error(
        ErrorCode::invalid_input, "pixel_mm",
        "The solid would have more than 64 million points: raise the detail spacing (pixel_mm) or lower the width.");
  map.columns = std::max(2, static_cast<int>(nodes_x));
  map.rows = std::max(2, static_cast<int>(nodes_y));
  map.pitch_x_mm = plate.width_mm / (map.columns - 1);
  map.pitch_y_mm = plate.height_mm / (map.rows - 1);
  map.height_mm.assign(static_cast<std::size_t>(map.columns) * static_cast<std::size_t>(map.rows), 0.0f);

  // Columns of G: position on the grid in nodes, height in mm.
  Positions G(moved.rows(), 3);
  G.col(0) = (moved.col(0).array() * size_mm + 0.5 * plate.width_mm) / map.pitch_x_mm;
  G.col(1) = (moved.col(1).array() * size_mm + 0.5 * plate.height_mm) / map.pitch_y_mm;
  G.col(2) = -size_mm * moved.col(2).array();

  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    if (f % 65536 == 0) context.check_cancelled();
    const Vec3 a = G.row(F(f, 0)).transpose(), b = G.row(F(f, 1)).transpose(), c = G.row(F(f, 2)).transpose();
    if (std::max({a.z(), b.z(), c.z()}) <= 0) continue;
    const double doubled = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
    if (doubled == 0) continue;  // edge-on: its neighbours cover the same nodes
    const int x0 = std::max(0, static_cast<int>(std::ceil(std::min({a.x(), b.x(), c.x()}) - 1e-9)));
    const int x1 = std::min(map.columns - 1, static_cast<int>(std::floor(std::max({a.x(), b.x(), c.x()}) + 1e-9)));
    const int y0 = std::max(0, static_cast<int>(std::ceil(std::min({a.y(), b.y(), c.y()}) - 1e-9)));
    const int y1 = std::min(map.rows - 1, static_cast<int>(std::floor(std::max({a.y(), b.y(), c.y()}) + 1e-9)));
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        const double wb = ((x - a.x()) * (c.y() - a.y()) - (y - a.y()) * (c.x() - a.x())) / doubled;
        const double wc = ((b.x() - a.x()) * (y - a.y()) - (b.y() - a.y()) * (x - a.x())) / doubled;
        const double wa = 1 - wb - wc;
        if (wa < -1e-9 || wb < -1e-9 || wc < -1e-9) continue;
        const double height = std::clamp(wa * a.z() + wb * b.z() + wc * c.z(), 0.0, top_mm);
        map.at(y, x) = std::max(map.at(y, x), static_cast<float>(height));
      }
  }
  for (Eigen::Index i = 0; i < G.rows(); ++i)
    if (G(i, 2) > top_mm * (1 - 1e-6)) {
      const int x = std::clamp(static_cast<int>(std::lround(G(i, 0))), 0, map.columns - 1);
      const int y = std::clamp(static_cast<int>(std::lround(G(i, 1))), 0, map.rows - 1);
      map.at(y, x) = static_cast<float>(top_mm);
    }
  return map;
}

}  // namespace formwright
