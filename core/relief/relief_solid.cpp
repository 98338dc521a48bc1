// SPDX-License-Identifier: GPL-3.0-or-later
// The solid of height_map.h.
#include <cmath>

#include "relief/height_map.h"
#include "geometry/mesh/mesh_lists.h"
#include "relief/right_triangle_network.h"

namespace formwright {
namespace {

/// The plate's rim, counter-clockwise from the lower left corner, as far as the network uses its nodes.
std::vector<int> rim_vertices(const HeightMap& map, const std::vector<int>& vertex_of) {
  std::vector<int> rim;
  const auto visit = [&](int x, int y) {
    const int vertex =
        vertex_of[static_cast<std::size_t>(y) * static_cast<std::size_t>(map.columns) + static_cast<std::size_t>(x)];
    if (vertex >= 0) rim.push_back(vertex);
  };
  for (int x = 0; x + 1 < map.columns; ++x) visit(x, 0);
  for (int y = 0; y + 1 < map.rows; ++y) visit(map.columns - 1, y);
  for (int x = map.columns - 1; x > 0; --x) visit(x, map.rows - 1);
  for (int y = map.rows - 1; y > 0; --y) visit(0, y);
  return rim;
}

}  // namespace

TriangleMesh make_solid(const HeightMap& map, double plate_mm, double tolerance_mm, Context& context) {
  const auto height = [&](GridNode p) { return map.at(p.y, p.x); };
  RightTriangleNetwork network(
      map.columns, map.rows, static_cast<float>(tolerance_mm),
      [&](GridNode a, GridNode b, GridNode m) { return std::abs(0.5f * (height(a) + height(b)) - height(m)); });
  network.find_bounds(context);
  network.collect();

  std::vector<int> vertex_of(map.height_mm.size(), -1);
  std::vector<Vec3> vertices;
  std::vector<Eigen::Vector3i> faces;
  faces.reserve(network.corners.size() / 3);
  for (std::size_t t = 0; t < network.corners.size(); t += 3) {
    Eigen::Vector3i face;
    for (int k = 0; k < 3; ++k) {
      const GridNode p = network.corners[t + static_cast<std::size_t>(k)];
      int& vertex = vertex_of[static_cast<std::size_t>(p.y) * static_cast<std::size_t>(map.columns) +
                              static_cast<std::size_t>(p.x)];
      if (vertex < 0) {
        vertex = static_cast<int>(vertices.size());
        vertices.emplace_back(p.x * map.pitch_x_mm, p.y * map.pitch_y_mm,
                              plate_mm + (static_cast<double>(map.at(p.y, p.x)) - map.floor_mm));
      }
      face[k] = vertex;
    }
    faces.push_back(face);
  }

  const std::vector<int> rim = rim_vertices(map, vertex_of);
  const int below = static_cast<int>(vertices.size());
  for (const int top : rim)
    vertices.emplace_back(vertices[static_cast<std::size_t>(top)].x(), vertices[static_cast<std::size_t>(top)].y(),
                          0.0);
  const int centre = static_cast<int>(vertices.size());
  vertices.emplace_back(0.5 * map.width_mm(), 0.5 * map.depth_mm(), 0.0);
  const int count = static_cast<int>(rim.size());
  for (int k = 0; k < count; ++k) {
    const int next = (k + 1) % count;
    const int top = rim[static_cast<std::size_t>(k)], top_next = rim[static_cast<std::size_t>(next)];
    faces.emplace_back(top_next, top, below + k);
    faces.emplace_back(top_next, below + k, below + next);
    faces.emplace_back(below + next, below + k, centre);
  }

  return mesh_of(vertices, faces);
}

}  // namespace formwright
