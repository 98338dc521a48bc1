// SPDX-License-Identifier: GPL-3.0-or-later
// The solid of height_map.h. Triangles of the network are right isosceles, named by their corners: a and b at
// the ends of the hypotenuse, c at the right angle; splitting joins c to the middle of a b.
#include <algorithm>
#include <bit>
#include <cmath>

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
    bound_.assign(static_cast<std::size_t>(size_ + 1) * static_cast<std::size_t>(size_ + 1), 0.0f);
  }

  void find_bounds(Context& context) {
    // Triangle number i descends from one of two halves of the square by the bits of i + 2; larger numbers are
    // smaller triangles, so going down sees children before their parents.
    const std::size_t count = 2 * static_cast<std::size_t>(size_) * static_cast<std::size_t>(size_) - 2;
    const std::size_t parents = count - static_cast<std::size_t>(size_) * static_cast<std::size_t>(size_);
    for (std::size_t i = count; i-- > 0;) {
      if (i % (1u << 20) == 0) context.check_cancelled();
      Node a{}, b{}, c{};
      std::size_t id = i + 2;
      if (id & 1) b.x = b.y = c.x = size_;
      else a.x = a.y = c.y = size_;
      while ((id >>= 1) > 1) {
        const Node m{(a.x + b.x) / 2, (a.y + b.y) / 2};
        if (id & 1) {
          b = a;
          a = c;
        } else {
          a = b;
          b = c;
        }
        c = m;
      }
      if (outside(a, b, c)) continue;
      float& bound = bound_at({(a.x + b.x) / 2, (a.y + b.y) / 2});
      if (crosses_edge(a, b, c)) {
        bound = INFINITY;
        continue;
      }
      // The children leave the parent's plane by `own` at most, and what they drop lies near their planes.
      const Node m{(a.x + b.x) / 2, (a.y + b.y) / 2};
      float total = std::abs(0.5f * (height(a) + height(b)) - height(m));
      if (i < parents)
        total += std::max(bound_at({(a.x + c.x) / 2, (a.y + c.y) / 2}), bound_at({(b.x + c.x) / 2, (b.y + c.y) / 2}));
      bound = std::max(bound, total);
    }
  }

  std::vector<Node> corners;  // three a triangle, counter-clockwise with x right and y up

  void collect() {
    descend({0, 0}, {size_, size_}, {size_, 0});
    descend({size_, size_}, {0, 0}, {0, size_});
  }

 private:
  float height(Node p) const { return map_.at(p.y, p.x); }
  float& bound_at(Node p) {
    return bound_[static_cast<std::size_t>(p.y) * static_cast<std::size_t>(size_ + 1) + static_cast<std::size_t>(p.x)];
  }
  bool outside(Node a, Node b, Node c) const {
    return std::min({a.x, b.x, c.x}) >= map_.columns - 1 || std::min({a.y, b.y, c.y}) >= map_.rows - 1;
  }
  bool crosses_edge(Node a, Node b, Node c) const {
    return std::max({a.x, b.x, c.x}) > map_.columns - 1 || std::max({a.y, b.y, c.y}) > map_.rows - 1;
  }
  void descend(Node a, Node b, Node c) {
    if (outside(a, b, c)) return;
    const Node m{(a.x + b.x) / 2, (a.y + b.y) / 2};
    if (std::abs(a.x - c.x) + std::abs(a.y - c.y) > 1 && bound_at(m) > tolerance_) {
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
                              plate_mm + static_cast<double>(map.at(p.y, p.x)));
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
