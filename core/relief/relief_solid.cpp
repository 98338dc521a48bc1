// SPDX-License-Identifier: GPL-3.0-or-later
// The solid of height_map.h. Triangles of the network are right isosceles, named by their corners: a and b at
// the ends of the hypotenuse, c at the right angle; splitting joins c to the middle of a b.
#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "relief/height_map.h"

namespace formwright {
namespace {

struct Node {
  int x, y;
};

class Network {
 public:
  Network(const HeightMap& map, double tolerance) : map_(map), tolerance_(static_cast<float>(tolerance)) {
    const auto longest = static_cast<unsigned>(std::max(map.columns, map.rows) - 1);
    size_ = static_cast<int>(std::bit_ceil(longest));
    bound_.assign(map.height_mm.size(), 0.0f);
  }

  /// Children before their parents: in squares of every size, from small to large, first the four triangles over the
  /// sides, then the two over the diagonal, which runs to the middle of the square of twice the size.
  void find_bounds(Context& context) {
    for (int side = 2; side <= size_; side *= 2) {
      for_squares(side, context, [&](int x, int y) {
        const Node middle{x + side / 2, y + side / 2};
        const Node corner[4] = {{x, y}, {x + side, y}, {x + side, y + side}, {x, y + side}};
        for (int k = 0; k < 4; ++k) raise_bound(corner[k], corner[(k + 1) % 4], middle, side > 2);
      });
      for_squares(side, context, [&](int x, int y) {
        Node a{x, y}, b{x + side, y + side}, c{x + side, y}, d{x, y + side};
        if ((x / side + y / side) % 2 != 0) {
          std::swap(a, c);
          std::swap(b, d);
        }
        raise_bound(a, b, c, true);
        raise_bound(a, b, d, true);
      });
    }
  }

  std::vector<Node> corners;  // three a triangle, counter-clockwise with x right and y up

  void collect() {
    descend({0, 0}, {size_, size_}, {size_, 0});
    descend({size_, size_}, {0, 0}, {0, size_});
  }

 private:
  /// Those that lie on the map at least in part.
  template <class Visit>
  void for_squares(int side, Context& context, Visit&& visit) const {
    for (int y = 0; y < map_.rows - 1; y += side) {
      context.check_cancelled();
      for (int x = 0; x < map_.columns - 1; x += side) visit(x, y);
    }
  }
  void raise_bound(Node a, Node b, Node c, bool has_children) {
    const Node m = between(a, b);
    if (outside(a, b, c) || beyond(m)) return;
    float& bound = bound_at(m);
    if (crosses_edge(a, b, c)) {
      bound = INFINITY;
      return;
    }
    // The children leave the parent's plane by `own` at most, and what they drop lies near their planes.
    const float own = std::abs(0.5f * (height(a) + height(b)) - height(m));
    const float theirs = has_children ? std::max(bound_at(between(a, c)), bound_at(between(b, c))) : 0.0f;
    bound = std::max(bound, own + theirs);
  }
  static Node between(Node a, Node b) { return {(a.x + b.x) / 2, (a.y + b.y) / 2}; }
  float height(Node p) const { return map_.at(p.y, p.x); }
  float& bound_at(Node p) {
    return bound_[static_cast<std::size_t>(p.y) * static_cast<std::size_t>(map_.columns) +
                  static_cast<std::size_t>(p.x)];
  }
  bool beyond(Node p) const { return p.x >= map_.columns || p.y >= map_.rows; }
  bool outside(Node a, Node b, Node c) const {
    return std::min({a.x, b.x, c.x}) >= map_.columns - 1 || std::min({a.y, b.y, c.y}) >= map_.rows - 1;
  }
  bool crosses_edge(Node a, Node b, Node c) const {
    return std::max({a.x, b.x, c.x}) > map_.columns - 1 || std::max({a.y, b.y, c.y}) > map_.rows - 1;
  }
  void descend(Node a, Node b, Node c) {
    if (outside(a, b, c)) return;
    const Node m = between(a, b);
    // Beyond the map's edge there are no bounds: a triangle that reaches there is split.
    if (std::abs(a.x - c.x) + std::abs(a.y - c.y) > 1 && (beyond(m) || bound_at(m) > tolerance_)) {
      descend(c, a, m);
      descend(b, c, m);
      return;
    }
    // a -> b -> c turns clockwise for one half and counter-clockwise for the other nowhere: both start alike.
    const long turn = static_cast<long>(b.x - a.x) * (c.y - a.y) - static_cast<long>(b.y - a.y) * (c.x - a.x);
    corners.push_back(a);
    corners.push_back(turn > 0 ? b : c);
    corners.push_back(turn > 0 ? c : b);
  }

  const HeightMap& map_;
  float tolerance_;
  int size_ = 1;
  std::vector<float> bound_;
};

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
  Network network(map, tolerance_mm);
  network.find_bounds(context);
  network.collect();

  std::vector<int> vertex_of(map.height_mm.size(), -1);
  std::vector<Vec3> vertices;
  std::vector<Eigen::Vector3i> faces;
  faces.reserve(network.corners.size() / 3);
  for (std::size_t t = 0; t < network.corners.size(); t += 3) {
    Eigen::Vector3i face;
    for (int k = 0; k < 3; ++k) {
      const Node p = network.corners[t + static_cast<std::size_t>(k)];
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

  TriangleMesh solid;
  solid.V.resize(static_cast<Eigen::Index>(vertices.size()), 3);
  for (std::size_t i = 0; i < vertices.size(); ++i) solid.V.row(static_cast<Eigen::Index>(i)) = vertices[i].transpose();
  solid.F.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t i = 0; i < faces.size(); ++i) solid.F.row(static_cast<Eigen::Index>(i)) = faces[i].transpose();
  return solid;
}

}  // namespace formwright
