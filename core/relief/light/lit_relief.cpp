// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/light/lit_relief.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/index.h"
#include "base/parallel.h"

namespace formwright {
namespace {

constexpr double max_nodes = 1e6;
constexpr std::size_t node_rows_per_chunk = 8;
constexpr double inset = 1e-6;  // of a pitch: on the plate's very edge a ray could pass beside it

// Rise over run beyond which the surface between two nodes is a wall, which belongs to neither of them: 63 degrees.
constexpr double wall_slope = 2;

/// Of the slopes to the neighbours before and after: their mean, but where one of them is a wall, the other.
double slope_of(double before, double after) {
  const bool wall_before = std::abs(before) > wall_slope, wall_after = std::abs(after) > wall_slope;
  if (wall_before != wall_after) return wall_before ? after : before;
  return 0.5 * (before + after);
}

}  // namespace

double LitRelief::at(const std::vector<double>& values, double x_mm, double y_mm) const {
  const auto split = [](double place, int count) {
    const double inside = std::clamp(place, 0.0, static_cast<double>(count - 1));
    const int first = std::min(static_cast<int>(inside), count - 2);
    return std::pair{first, inside - first};
  };
  const auto [column, s] = split(x_mm / pitch_x_mm + 0.5 * (columns - 1), columns);
  const auto [row, t] = split(y_mm / pitch_y_mm + 0.5 * (rows - 1), rows);
  const std::size_t p = index(row) * index(columns) + index(column), q = p + index(columns);
  return (1 - t) * ((1 - s) * values[p] + s * values[p + 1]) + t * ((1 - s) * values[q] + s * values[q + 1]);
}

LitRelief make_lit_relief(const LitObject& solid, PlateSize plate, double pitch_mm, double clearance_mm,
                          Context& context) {
  LitRelief relief;
  const double columns = std::max(2.0, std::ceil(plate.width_mm / pitch_mm - 1e-9) + 1),
               rows = std::max(2.0, std::ceil(plate.height_mm / pitch_mm - 1e-9) + 1);
  if (!(columns * rows <= max_nodes))
    throw Error(ErrorCode::invalid_input, "light_pixel_mm",
                "The light would be computed at more than a million points: give a larger spacing "
                "(light_pixel_mm).");
  relief.columns = static_cast<int>(columns);
  relief.rows = static_cast<int>(rows);
  relief.pitch_x_mm = plate.width_mm / (relief.columns - 1);
  relief.pitch_y_mm = plate.height_mm / (relief.rows - 1);
  const auto count = static_cast<Eigen::Index>(relief.columns) * relief.rows;
  relief.nodes.clearance = clearance_mm;
  relief.nodes.place.resize(count, 3);
  relief.nodes.normal.resize(count, 3);
  const auto node = [&](int row, int column) { return static_cast<Eigen::Index>(row) * relief.columns + column; };
  const double above = solid.high.z() + 1, reach = solid.high.z() - solid.low.z() + 2;
  const auto place = [](int k, int nodes, double pitch) {
    return std::clamp(k - 0.5 * (nodes - 1), -0.5 * (nodes - 1) + inset, 0.5 * (nodes - 1) - inset) * pitch;
  };
  parallel_for(index(relief.rows), node_rows_per_chunk, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row)
      for (int column = 0; column < relief.columns; ++column) {
        const double x = place(column, relief.columns, relief.pitch_x_mm),
                     y = place(row, relief.rows, relief.pitch_y_mm);
        const auto hit = solid.rays->first_hit(Vec3(x, y, above), Vec3(0, 0, -1), 0, reach);
        relief.nodes.place.row(node(row, column)) << x, y, hit ? above - hit->distance : solid.low.z();
      }
  });
  const auto z = [&](int row, int column) {
    return relief.nodes.place(node(std::clamp(row, 0, relief.rows - 1), std::clamp(column, 0, relief.columns - 1)), 2);
  };
  for (int row = 0; row < relief.rows; ++row)
    for (int column = 0; column < relief.columns; ++column) {
      const double here = z(row, column);
      const auto slope = [&](double before, double after, bool first, bool last, double pitch) {
        // At the plate's edge there is a neighbour on one side only.
        return first ? after / pitch : last ? before / pitch : slope_of(before / pitch, after / pitch);
      };
      const double along_x = slope(here - z(row, column - 1), z(row, column + 1) - here, column == 0,
                                   column == relief.columns - 1, relief.pitch_x_mm);
      const double along_y = slope(here - z(row - 1, column), z(row + 1, column) - here, row == 0,
                                   row == relief.rows - 1, relief.pitch_y_mm);
      relief.nodes.normal.row(node(row, column)) = Vec3(-along_x, -along_y, 1).normalized().transpose();
    }
  return relief;
}

TriangleMesh front_mesh(const LitRelief& relief) {
  TriangleMesh mesh;
  mesh.V = relief.nodes.place;
  mesh.F.resize(2 * static_cast<Eigen::Index>(relief.columns - 1) * (relief.rows - 1), 3);
  Eigen::Index f = 0;
  for (int row = 0; row + 1 < relief.rows; ++row)
    for (int column = 0; column + 1 < relief.columns; ++column) {
      const int a = row * relief.columns + column, b = a + 1, c = a + relief.columns, d = c + 1;
      mesh.F.row(f++) << a, b, d;
      mesh.F.row(f++) << a, d, c;
    }
  return mesh;
}

}  // namespace formwright
