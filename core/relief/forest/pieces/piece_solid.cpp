// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/forest/pieces/piece_solid.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "relief/right_triangle_network.h"

namespace formwright {
namespace {

constexpr double embedded_mm = 0.6;     // below the surface and what is carved, where the pillar is thick enough
constexpr double room_before_mm = 0.5;  // how far the room begins before the space of the relief

/// Two sheets over the covered cells of one grid, and the walls between them.
struct Sheets {
  int columns, rows;
  std::vector<char> covered;      // (rows - 1) * (columns - 1)
  std::vector<Vec3> front, back;  // rows * columns
  std::size_t node(GridNode p) const {
    return static_cast<std::size_t>(p.y) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(p.x);
  }
  bool is_covered(int column, int row) const {
    return covered[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns - 1) +
                   static_cast<std::size_t>(column)] != 0;
  }
  /// Whether the cells around a node differ.
  bool is_border(GridNode p) const {
    int count = 0, of = 0;
    for (int row = std::max(0, p.y - 1); row <= std::min(rows - 2, p.y); ++row)
      for (int column = std::max(0, p.x - 1); column <= std::min(columns - 2, p.x); ++column) {
        count += is_covered(column, row);
        ++of;
      }
    return count != 0 && count != of;
  }
};

TriangleMesh between(const Sheets& sheets, double tolerance_mm, Context& context) {
  const auto leaves = [&](GridNode a, GridNode b, GridNode m) -> float {
    if (sheets.is_border(m)) return INFINITY;
    const auto off = [&](const std::vector<Vec3>& sheet) {
      return (0.5 * (sheet[sheets.node(a)] + sheet[sheets.node(b)]) - sheet[sheets.node(m)]).norm();
    };
    return static_cast<float>(std::max(off(sheets.front), off(sheets.back)));
  };
  RightTriangleNetwork network(sheets.columns, sheets.rows, static_cast<float>(tolerance_mm), leaves);
  network.find_bounds(context);
  network.collect();

  std::vector<int> vertex_of(sheets.front.size(), -1);
  std::vector<GridNode> used;
  std::vector<Eigen::Vector3i> triangles;
  std::map<std::pair<int, int>, int> edges;  // +1 for each triangle in this direction
  for (std::size_t t = 0; t < network.corners.size(); t += 3) {
    const GridNode* p = &network.corners[t];
    const int x = (p[0].x + p[1].x + p[2].x) / 3, y = (p[0].y + p[1].y + p[2].y) / 3;
    if (!sheets.is_covered(x, y)) continue;
    Eigen::Vector3i face;
    for (int k = 0; k < 3; ++k) {
      int& vertex = vertex_of[sheets.node(p[k])];
      if (vertex < 0) {
        vertex = static_cast<int>(used.size());
        used.push_back(p[k]);
      }
      face[k] = vertex;
    }
    for (int k = 0; k < 3; ++k) {
      const int from = face[k], to = face[(k + 1) % 3];
      if (!edges.erase({to, from})) edges.emplace(std::pair{from, to}, 1);
    }
    triangles.push_back(face);
  }
  const int n = static_cast<int>(used.size());
  TriangleMesh mesh;
  mesh.V.resize(2 * n, 3);
  for (int i = 0; i < n; ++i) {
    mesh.V.row(i) = sheets.front[sheets.node(used[static_cast<std::size_t>(i)])].transpose();
    mesh.V.row(n + i) = sheets.back[sheets.node(used[static_cast<std::size_t>(i)])].transpose();
  }
  mesh.F.resize(static_cast<Eigen::Index>(2 * triangles.size() + 2 * edges.size()), 3);
  Eigen::Index f = 0;
  // Columns run to the viewer's right and rows upwards: counter-clockwise triangles face the viewer.
  for (const Eigen::Vector3i& face : triangles) {
    mesh.F.row(f++) = face.transpose();
    mesh.F.row(f++) << n + face[0], n + face[2], n + face[1];
  }
  for (const auto& [edge, count] : edges) {
    const auto& [from, to] = edge;
    mesh.F.row(f++) << to, from, n + from;
    mesh.F.row(f++) << to, n + from, n + to;
  }
  return mesh;
}

/// Distance ahead of the raised piece's back.
double back_of(const WallReach& reach, double aside) {
  const double embedded = embedded_mm / std::sqrt(1 + aside * aside);
  return reach.far + std::min(embedded, 0.5 * (reach.exit - reach.far));
}

}  // namespace

PieceSolids piece_solids(const PieceGrid& grid, const ForestView& view, const WallSpace& space, double tolerance_mm,
                         Context& context) {
  PieceSolids solids;
  const double eye_z = view.eye().z();
  Sheets raised{grid.columns(), grid.rows(), grid.covered, {}, {}};
  for (int row = 0; row < grid.rows(); ++row)
    for (int column = 0; column < grid.columns(); ++column) {
      const auto c = static_cast<std::size_t>(column);
      const double z = grid.z_mm[static_cast<std::size_t>(row)], aside = grid.aside[c];
      const WallReach& reach = grid.reach[c];
      raised.front.push_back(view.world({aside, (z - eye_z) / reach.surface, grid.front[grid.node(column, row)]}));
      const Vec2 behind = view.plan().at(aside, back_of(reach, aside));
      raised.back.emplace_back(behind.x(), behind.y(), z);
    }
  solids.raised = between(raised, tolerance_mm, context);
  if (space.below_mm == 0 || grid.columns() < 3 || grid.rows() < 3) return solids;

  // Nodes of the room are the middles of cells.
  Sheets room{grid.columns() - 1, grid.rows() - 1, {}, {}, {}};
  for (int row = 0; row < room.rows; ++row)
    for (int column = 0; column < room.columns; ++column) {
      const auto c = static_cast<std::size_t>(column), r = static_cast<std::size_t>(row);
      const auto mean = [&](auto of) { return 0.5 * (of(c) + of(c + 1)); };
      const double aside = mean([&](std::size_t k) { return grid.aside[k]; });
      const double surface = mean([&](std::size_t k) { return grid.reach[k].surface; }),
                   near = mean([&](std::size_t k) { return grid.reach[k].near; }),
                   far = mean([&](std::size_t k) { return grid.reach[k].far; }),
                   back = mean([&](std::size_t k) { return back_of(grid.reach[k], grid.aside[k]); });
      const double above = (0.5 * (grid.z_mm[r] + grid.z_mm[r + 1]) - eye_z) / surface;
      const std::size_t cell = grid.cell(column, row);
      const double front = grid.covered[cell] ? grid.middle_front[cell] : surface;
      room.front.push_back(view.world({aside, above, std::max(near - room_before_mm, 0.5 * near)}));
      room.back.push_back(view.world({aside, above, std::max(front, surface) + 0.5 * (back - far)}));
      if (column + 1 < room.columns && row + 1 < room.rows)
        room.covered.push_back(grid.covered[cell] && grid.covered[grid.cell(column + 1, row)] &&
                               grid.covered[grid.cell(column, row + 1)] &&
                               grid.covered[grid.cell(column + 1, row + 1)]);
    }
  part_crosswise_cells(room.covered, room.columns, room.rows);  // which those of the piece need not do
  if (std::ranges::find(room.covered, 1) != room.covered.end()) solids.room = between(room, tolerance_mm, context);
  return solids;
}

}  // namespace formwright
