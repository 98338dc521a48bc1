// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A bounding volume hierarchy over triangles, four children a node, for rays and for nearest points:
// Wald, Boulos, Shirley 2007 (surface area heuristic, binned); Ize 2013 "Robust BVH Ray Traversal".
// Boxes are single precision, rounded outwards; triangles stay in double precision.
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "base/lanes.h"
#include "geometry/queries/ray_triangle.h"
#include "geometry/queries/search_sphere.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

class TriangleBvh {
 public:
  static constexpr int width = 4;
  struct alignas(16) Node {
    std::array<Float4, 3> lower, upper;     // per axis, a lane per child, relative to the sphere's centre
    std::array<std::int32_t, width> child;  // a node, or ~block for a leaf
  };
  /// The triangles of one leaf, lane by lane, so that one instruction serves several of them.
  struct alignas(32) Block {
    TriangleCorners<Double4> corner;
    std::array<std::int32_t, width> face;  // in the mesh; -1 in an empty lane, whose corners are 0

    Vec3 position(std::size_t k, std::size_t lane) const {
      return {corner[k][0][lane], corner[k][1][lane], corner[k][2][lane]};
    }
  };

  /// Copies the triangles. Throws as search_sphere does.
  explicit TriangleBvh(const TriangleMesh& mesh);

  const SearchSphere& sphere() const { return sphere_; }

  /// Calls visit(block) for every leaf that the ray may touch within [near, far]; `far` may be lowered
  /// meanwhile. Nearer boxes come first. `ray` is centred in sphere().
  template <class Visit>
  void along_ray(const CentredRay& ray, double near, const double& far, Visit&& visit) const;

  /// Calls visit(block) for every leaf that may lie within sqrt(limit_squared) of `point`; the limit may
  /// be lowered meanwhile. Nearer boxes come first.
  template <class Visit>
  void near_point(const Vec3& point, const double& limit_squared, Visit&& visit) const;

  static constexpr int stack_size = 256;  // 3 entries a level; the builder keeps the depth below 80

 private:
  struct Builder;
  const Node& node(std::int32_t i) const { return nodes_[static_cast<std::size_t>(i)]; }  // 0 is the root
  const Block& leaf(std::int32_t child) const { return blocks_[static_cast<std::size_t>(~child)]; }
  static bool is_leaf(std::int32_t child) { return child < 0; }

  std::vector<Node> nodes_;
  std::vector<Block> blocks_;
  SearchSphere sphere_;
};

namespace bvh_detail {

struct Entry {
  std::int32_t child;
  float key;
};

/// Pushes the accepted children, farthest first.
inline void push_sorted(Entry* stack, int& top, const std::array<std::int32_t, 4>& child, const Float4& key,
                        unsigned accepted) {
  const int base = top;
  for (; accepted != 0; accepted &= accepted - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(accepted));
    int j = top++;
    for (; j > base && stack[j - 1].key < key[i]; --j) stack[j] = stack[j - 1];
    stack[j] = {child[i], key[i]};
  }
}

}  // namespace bvh_detail

template <class Visit>
void TriangleBvh::along_ray(const CentredRay& ray, double near, const double& far, Visit&& visit) const {
  if (ray.is_too_far) {
    for (const Block& block : blocks_) visit(block);
    return;
  }
  if (nodes_.empty() || ray.misses) return;
  // Counted from the foot, |t| <= 2 radii: three roundings move a slab by at most 3 * 2^-24 * 2 radii, those of the
  // foot and of the box by 2^-24 radii each, and the test lets hits lie 2e-7 radii outside. Together that is less
  // than the 1e-6 radii by which the builder has widened every box.
  std::array<float, 3> o{}, inverse{};
  std::array<std::array<Float4, 3> Node::*, 3> low{}, high{};  // the side that the ray enters and leaves by
  for (std::size_t k = 0; k < 3; ++k) {
    const double d = ray.direction[static_cast<int>(k)];
    o[k] = static_cast<float>(ray.foot[static_cast<int>(k)]);
    inverse[k] = static_cast<float>(std::abs(d) < 1e-18 ? (std::signbit(d) ? -1e18 : 1e18) : 1 / d);
    low[k] = inverse[k] < 0 ? &Node::upper : &Node::lower;
    high[k] = inverse[k] < 0 ? &Node::lower : &Node::upper;
  }
  const double reach = 4 * sphere_.radius, slack = 1e-6 * sphere_.radius;
  const float from = static_cast<float>(std::max(near - ray.start, -reach) - slack);

  std::array<bvh_detail::Entry, stack_size> stack;
  int top = 0;
  stack[top++] = {0, -std::numeric_limits<float>::infinity()};
  while (top > 0) {
    const bvh_detail::Entry entry = stack[--top];
    const double far_here = std::min(far - ray.start, reach) + slack;
    if (static_cast<double>(entry.key) > far_here) continue;
    if (is_leaf(entry.child)) {
      visit(leaf(entry.child));
      continue;
    }
    const Node& n = node(entry.child);
    Float4 entering = Float4{} + from, leaving = Float4{} + static_cast<float>(far_here);
    for (std::size_t k = 0; k < 3; ++k) {
      entering = greater(((n.*low[k])[k] - o[k]) * inverse[k], entering);
      leaving = lesser(((n.*high[k])[k] - o[k]) * inverse[k], leaving);
    }
    const unsigned accepted = lanes_set(entering <= leaving);
    bvh_detail::push_sorted(stack.data(), top, n.child, entering, accepted);
  }
}

template <class Visit>
void TriangleBvh::near_point(const Vec3& point, const double& limit_squared, Visit&& visit) const {
  if (nodes_.empty()) return;
  const Vec3 p = point - sphere_.centre;
  std::array<bvh_detail::Entry, stack_size> stack;
  int top = 0;
  stack[top++] = {0, 0};
  while (top > 0) {
    const bvh_detail::Entry entry = stack[--top];
    if (static_cast<double>(entry.key) > limit_squared) continue;
    if (is_leaf(entry.child)) {
      visit(leaf(entry.child));
      continue;
    }
    const Node& n = node(entry.child);
    Double4 squared{};
    for (std::size_t k = 0; k < 3; ++k) {
      const double x = p[static_cast<int>(k)];
      const Double4 below = __builtin_convertvector(n.lower[k], Double4) - x;
      const Double4 above = x - __builtin_convertvector(n.upper[k], Double4);
      const Double4 out = below > above ? below : above, zero{};
      const Double4 distance = out > zero ? out : zero;
      squared += distance * distance;
    }
    const Float4 key = __builtin_convertvector(squared * (1 - 1e-6), Float4);  // still a lower bound
    const unsigned accepted = lanes_set(squared <= Double4{} + limit_squared);
    bvh_detail::push_sorted(stack.data(), top, n.child, key, accepted);
  }
}

}  // namespace formwright
