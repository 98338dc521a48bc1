// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/seen/normal_picture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/index.h"
#include "base/parallel.h"

namespace formwright {
namespace {

constexpr double tan_arc_minute = 2.908882086657216e-4;
constexpr double far_distance = 2.8356409098088537;  // 0.5 / tan(10 degrees): the width fills 20 degrees
constexpr double max_pixels = 4e6;
constexpr double min_columns = 100;
constexpr std::size_t rows_per_band = 32;

struct Corner {
  double x, y, depth;            // in pixels; depth z / (1 + kappa z), linear over the face in the picture
  std::array<double, 3> normal;  // over 1 + kappa z
};

}  // namespace

PictureGrid eye_grid(const ViewFrame& frame) { return eye_grid(frame, 1); }

PictureGrid eye_grid(const ViewFrame& frame, double factor) {
  const double distance = frame.kappa > 0 ? 1 / frame.kappa : far_distance;
  PictureGrid grid;
  grid.pixel = std::min(factor * distance * tan_arc_minute, 1 / min_columns);
  grid.pixel = std::max(grid.pixel, std::sqrt(frame.image_height / max_pixels));
  grid.columns = std::max(1, static_cast<int>(std::ceil(1 / grid.pixel - 1e-9)));
  grid.rows = std::max(1, static_cast<int>(std::ceil(frame.image_height / grid.pixel - 1e-9)));
  grid.arc_minutes_per_pixel = grid.pixel / (distance * tan_arc_minute);
  return grid;
}

NormalPicture draw_normals(const ViewFrame& frame, const Positions& positions, const Triangles& F,
                           const PictureGrid& grid, Context& context) {
  const Eigen::Index n = positions.rows();
  NormalPicture picture;
  picture.grid = grid;
  const std::size_t count = index(grid.columns) * index(grid.rows);
  picture.x.assign(count, 0);
  picture.y.assign(count, 0);
  picture.z.assign(count, 0);
  picture.covered.assign(count, 0);

  // View axes (right, up, away) are left-handed: cross products point inwards.
  Positions inward = Positions::Zero(n, 3);
  std::vector<char> turned_away(static_cast<std::size_t>(F.rows()));
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    const Vec3 a = positions.row(F(f, 0)).transpose(), b = positions.row(F(f, 1)).transpose(),
               c = positions.row(F(f, 2)).transpose();
    const Vec3 cross = (b - a).cross(c - a), middle = (a + b + c) / 3;
    for (int k = 0; k < 3; ++k) inward.row(F(f, k)) += cross.transpose();
    const Vec3 ray(frame.kappa * middle.x(), frame.kappa * middle.y(), 1 + frame.kappa * middle.z());
    turned_away[static_cast<std::size_t>(f)] = cross.dot(ray) < 0;
  }
  std::vector<Corner> corners(static_cast<std::size_t>(n));
  for (Eigen::Index i = 0; i < n; ++i) {
    const double w = 1 + frame.kappa * positions(i, 2), length = inward.row(i).norm();
    const double s = length > 0 ? 1 / (length * w) : 0;
    corners[static_cast<std::size_t>(i)] = {positions(i, 0) / w / grid.pixel + 0.5 * grid.columns - 0.5,
                                            positions(i, 1) / w / grid.pixel + 0.5 * grid.rows - 0.5,
                                            positions(i, 2) / w,
                                            {-inward(i, 0) * s, -inward(i, 1) * s, inward(i, 2) * s}};
  }

  std::vector<float> nearest(count, std::numeric_limits<float>::infinity());
  parallel_for(index(grid.rows), rows_per_band, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (Eigen::Index f = 0; f < F.rows(); ++f) {
      const Corner &a = corners[index(F(f, 0))], &b = corners[index(F(f, 1))], &c = corners[index(F(f, 2))];
      const double low = std::min({a.y, b.y, c.y}), high = std::max({a.y, b.y, c.y});
      if (high < static_cast<double>(begin) || low > static_cast<double>(end) - 1) continue;
      const double doubled = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
      if (doubled == 0) continue;  // edge-on: its neighbours cover the same pixels
      const int y0 = std::max(static_cast<int>(begin), static_cast<int>(std::ceil(low - 1e-9)));
      const int y1 = std::min(static_cast<int>(end) - 1, static_cast<int>(std::floor(high + 1e-9)));
      const int x0 = std::max(0, static_cast<int>(std::ceil(std::min({a.x, b.x, c.x}) - 1e-9)));
      const int x1 = std::min(grid.columns - 1, static_cast<int>(std::floor(std::max({a.x, b.x, c.x}) + 1e-9)));
      const double side = turned_away[static_cast<std::size_t>(f)] ? -1 : 1;
      for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) {
          const double wb = ((x - a.x) * (c.y - a.y) - (y - a.y) * (c.x - a.x)) / doubled;
          const double wc = ((b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x)) / doubled;
          const double wa = 1 - wb - wc;
          if (wa < -1e-9 || wb < -1e-9 || wc < -1e-9) continue;
          const std::size_t p = picture.at(y, x);
          const auto depth = static_cast<float>(wa * a.depth + wb * b.depth + wc * c.depth);
          if (!(depth < nearest[p])) continue;
          const Vec3 normal(wa * a.normal[0] + wb * b.normal[0] + wc * c.normal[0],
                            wa * a.normal[1] + wb * b.normal[1] + wc * c.normal[1],
                            wa * a.normal[2] + wb * b.normal[2] + wc * c.normal[2]);
          const double length = normal.norm();
          const double s = length > 0 ? side / length : 0;
          nearest[p] = depth;
          picture.x[p] = static_cast<float>(s * normal.x());
          picture.y[p] = static_cast<float>(s * normal.y());
          picture.z[p] = static_cast<float>(s * normal.z());
          picture.covered[p] = 1;
        }
    }
  });
  return picture;
}

}  // namespace formwright
