// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/mill/mill_tool.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/parallel.h"

namespace formwright {

HeightField HeightField::transposed() const {
  HeightField result{rows, columns, pitch_y_mm, pitch_x_mm, std::vector<float>(z_mm.size())};
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) result.at(c, r) = at(r, c);
  return result;
}

double MillTool::profile_mm(double distance_mm) const {
  const double radius = diameter_mm / 2;
  if (distance_mm > radius) return std::numeric_limits<double>::infinity();
  if (shape == ToolShape::ball) return radius - std::sqrt(std::max(0.0, radius * radius - distance_mm * distance_mm));
  if (shape == ToolShape::v)
    return std::max(0.0, distance_mm - v_tip_mm / 2) / std::tan(v_angle_degrees / 2 * std::numbers::pi / 180);
  return 0;
}

ToolFootprint footprint(const MillTool& tool, const HeightField& grid, double shift_columns) {
  ToolFootprint result;
  const double radius = tool.diameter_mm / 2;
  result.reach_rows = static_cast<int>(radius / grid.pitch_y_mm) + 1;
  result.reach_columns = static_cast<int>(radius / grid.pitch_x_mm) + 2;
  for (int r = -result.reach_rows; r <= result.reach_rows; ++r)
    for (int c = -result.reach_columns; c <= result.reach_columns; ++c) {
      const double x = (c - shift_columns) * grid.pitch_x_mm, y = r * grid.pitch_y_mm,
                   distance = std::sqrt(x * x + y * y);
      // A node on the rim to the last bit counts as under the tool.
      if (distance > radius * (1 + 1e-12)) continue;
      result.nodes.push_back({r, c, static_cast<float>(tool.profile_mm(std::min(distance, radius)))});
    }
  return result;
}

ToolFootprint swept_footprint(const MillTool& tool, const HeightField& grid) {
  ToolFootprint result;
  const double radius = tool.diameter_mm / 2, ring = 0.7 * radius, step = grid.pitch_x_mm;
  result.reach_rows = static_cast<int>(radius / grid.pitch_y_mm) + 1;
  result.reach_columns = static_cast<int>(radius / step) + 2;
  for (int r = -result.reach_rows; r <= result.reach_rows; ++r)
    for (int c = -result.reach_columns; c <= result.reach_columns; ++c) {
      const double x = std::abs(c) * step, y = r * grid.pitch_y_mm;
      const auto distance = [&](double along) { return std::sqrt(along * along + y * y); };
      double height = distance(x) <= radius * (1 + 1e-12) ? tool.profile_mm(std::min(distance(x), radius))
                                                          : std::numeric_limits<double>::infinity();
      // The profile grows with the distance: the nearest one of the swept part counts.
      const double nearest = std::max(distance(std::max(0.0, x - step)), ring);
      if (nearest <= radius * (1 + 1e-12) && distance(x + step) >= ring)
        height = std::min(height, tool.profile_mm(std::min(nearest, radius)));
      if (std::isfinite(height)) result.nodes.push_back({r, c, static_cast<float>(height)});
    }
  return result;
}

HeightField lowest_tips(const HeightField& field, const ToolFootprint& tool, const Context& context) {
  HeightField tips = field;
  std::fill(tips.z_mm.begin(), tips.z_mm.end(), -std::numeric_limits<float>::infinity());
  parallel_for(static_cast<std::size_t>(field.rows), 16, [&](std::size_t begin, std::size_t end) {
    for (auto row = static_cast<int>(begin); row < static_cast<int>(end); ++row) {
      context.check_cancelled();
      float* out = &tips.at(row, 0);
      for (const ToolFootprint::Node& node : tool.nodes) {
        if (row + node.row < 0 || row + node.row >= field.rows) continue;
        const float* in = &field.z_mm[field.index(row + node.row, 0)];
        const int from = std::max(0, -node.column), to = std::min(field.columns, field.columns - node.column);
        for (int c = from; c < to; ++c) out[c] = std::max(out[c], in[c + node.column] - node.height_mm);
      }
    }
  });
  return tips;
}

void carve(HeightField& field, const HeightField& tips, const ToolFootprint& tool, const Context& context) {
  parallel_for(static_cast<std::size_t>(field.rows), 16, [&](std::size_t begin, std::size_t end) {
    for (auto row = static_cast<int>(begin); row < static_cast<int>(end); ++row) {
      context.check_cancelled();
      float* out = &field.at(row, 0);
      for (const ToolFootprint::Node& node : tool.nodes) {
        if (row - node.row < 0 || row - node.row >= field.rows) continue;
        const float* in = &tips.z_mm[tips.index(row - node.row, 0)];
        const int from = std::max(0, node.column), to = std::min(field.columns, field.columns + node.column);
        for (int c = from; c < to; ++c) out[c] = std::min(out[c], in[c - node.column] + node.height_mm);
      }
    }
  });
}

double scallop_mm(double diameter_mm, double stepover_mm) {
  const double radius = diameter_mm / 2, half = std::min(stepover_mm / 2, radius);
  return radius - std::sqrt(radius * radius - half * half);
}

}  // namespace formwright
