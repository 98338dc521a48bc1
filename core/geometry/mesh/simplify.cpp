// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/simplify.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/index.h"
#include "base/statistics.h"
#include "base/error.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/collapsible_mesh.h"
#include "geometry/mesh/measures.h"
#include "geometry/mesh/quadric.h"
#include "geometry/mesh/triangle_improvement.h"

namespace formwright {
namespace {

/// Variance of a face's normal: about 2 degrees. More spreads the vertices, less follows curvature.
constexpr double normal_variance = 1e-3;
/// Of the plane that holds a boundary edge in place, against the face beside it.
constexpr double boundary_weight = 20;
/// A face may turn by at most acos of this in one collapse.
constexpr double min_turn_cosine = 0.3;
/// Shape (1 for equilateral, 0 for flat) below which a collapse is put off, and below which it is refused.
constexpr double fair_shape = 0.35, min_shape = 0.05;

/// An edge waiting to be collapsed. Stale when `stamp` is no longer the sum of its ends' stamps.
struct CollapseCandidate {
  float cost;
  std::uint32_t stamp;
  int a, b;
  static constexpr std::uint32_t weighed_bit = 0x80000000u;  // its shape is part of the cost already
};
/// Heaps have the greatest on top, so "less" is "costs more"; ties fall by the vertices' numbers.
bool costs_more(const CollapseCandidate& p, const CollapseCandidate& q) {
  if (p.cost != q.cost) return p.cost > q.cost;
  return p.a != q.a ? p.a > q.a : p.b > q.b;
}

/// A priority queue that keeps only the cheapest part in a heap. Costly candidates, most of which go
/// stale before their turn, wait in a plain list: five million faces stay within the caches.
class Queue {
 public:
  void push(const CollapseCandidate& candidate) {
    if (candidate.cost > limit_) {
      later_.push_back(candidate);
      return;
    }
    heap_.push_back(candidate);
    std::push_heap(heap_.begin(), heap_.end(), costs_more);
  }
  /// False when nothing valid is left. `valid` tells whether a candidate is still worth keeping.
  template <class Valid>
  bool pop(CollapseCandidate& candidate, const Valid& valid) {
    while (heap_.empty()) {
      if (later_.empty()) return false;
      std::erase_if(later_, [&](const CollapseCandidate& c) { return !valid(c); });
      if (later_.empty()) return false;
      const std::size_t share = std::min(later_.size(), std::max<std::size_t>(20000, later_.size() / 8));
      std::vector<float> costs(later_.size());
      std::transform(later_.begin(), later_.end(), costs.begin(), [](const CollapseCandidate& c) { return c.cost; });
      limit_ = value_of_rank(costs, share - 1);
      const auto waiting =
          std::partition(later_.begin(), later_.end(), [&](const CollapseCandidate& c) { return c.cost > limit_; });
      heap_.assign(waiting, later_.end());
      later_.erase(waiting, later_.end());
      std::make_heap(heap_.begin(), heap_.end(), costs_more);
    }
    std::pop_heap(heap_.begin(), heap_.end(), costs_more);
    candidate = heap_.back();
    heap_.pop_back();
    return true;
  }
  float cheapest() const { return heap_.empty() ? limit_ : heap_.front().cost; }

 private:
  std::vector<CollapseCandidate> heap_, later_;
  float limit_ = -1;
};

class Simplifier {
 public:
  Simplifier(const TriangleMesh& mesh, const Adjacency& adjacency)
      : mesh_(adjacency), merged_into_(index(mesh.vertex_count()), -1) {
    // Unit size about the origin: quadrics lose digits far from it.
    const BoundingBox box = bounding_box(mesh);
    centre_ = box.centre();
    scale_ = box.diagonal() > 0 ? box.diagonal() : 1;
    position_.resize(index(mesh.vertex_count()));
    for (int v = 0; v < mesh.vertex_count(); ++v) position_[index(v)] = (Vec3(mesh.V.row(v)) - centre_) / scale_;
    stamp_.assign(index(mesh.vertex_count()), 0);
    quadric_.resize(index(mesh.vertex_count()));
    for (int v = 0; v < mesh.vertex_count(); ++v) vertices_ += mesh_.has_vertex(v) ? 1 : 0;
  }

  int vertices() const { return vertices_; }

  /// Leaves out parts whose bounding box is smaller than an edge of the result will be.
  void drop_small_parts(const TriangleMesh& mesh, const Adjacency& adjacency, int target) {
    const Components parts = face_components(adjacency);
    std::vector<BoundingBox> box(index(parts.count));
    for (int h = 0; h < 3 * mesh.face_count(); ++h)
      box[index(parts.of[index(h / 3)])].add(mesh.V.row(adjacency.from(h)));
    const double edge = std::sqrt(2 * surface_area(mesh) / (std::sqrt(3.0) * target));
    for (int f = 0; f < mesh.face_count(); ++f)
      if (box[index(parts.of[index(f)])].diagonal() < edge)
        for (int k = 0; k < 3; ++k) {
          const int v = mesh.F(f, k);
          vertices_ -= merged_into_[index(v)] == -2 ? 0 : 1;
          merged_into_[index(v)] = -2;
        }
  }
  bool dropped(int v) const { return merged_into_[index(v)] == -2; }

  void collapse_to(int target, Context& context) {
    gather_quadrics();
    const int at_first = vertices_;
    for (int h = 0; h < 3 * mesh_.face_count(); ++h) {
      if (dropped(mesh_.from(h))) continue;
      const int g = mesh_.opposite(h);
      if (g < 0 || g > h) enqueue(mesh_.from(h), mesh_.to(h));
    }
    const auto valid = [&](const CollapseCandidate& c) {
      return mesh_.has_vertex(c.a) && mesh_.has_vertex(c.b) &&
             (c.stamp & ~CollapseCandidate::weighed_bit) == stamp_of(c.a, c.b);
    };
    CollapseCandidate candidate{};
    for (long long steps = 0; vertices_ > target && queue_.pop(candidate, valid); ++steps) {
      if ((steps & 0x1fff) == 0)
        context.progress(static_cast<double>(at_first - vertices_) / std::max(1, at_first - target));
      if (valid(candidate)) consider(candidate);
    }
  }

  /// Only what the collapses have touched: the rest is as it was asked for.
  void improve(const Context& context) {
    std::vector<Freedom> freedom(position_.size(), Freedom::flip);
    for (std::size_t v = 0; v < freedom.size(); ++v)
      freedom[v] = merged_into_[v] == -2 ? Freedom::none : stamp_[v] > 0 ? Freedom::move : Freedom::flip;
    improve_triangles(mesh_, position_, quadric_, freedom, last_cost_, context);
  }

  TriangleMesh extract(std::vector<int>* new_vertex_of) const {
    TriangleMesh result;
    std::vector<int> name(position_.size(), -1);
    result.V.resize(vertices_, 3);
    int n = 0;
    for (std::size_t v = 0; v < position_.size(); ++v) {
      if (!mesh_.has_vertex(static_cast<int>(v)) || merged_into_[v] == -2) continue;
      result.V.row(n) = position_[v] * scale_ + centre_;
      name[v] = n++;
    }
    std::vector<int> corners;
    for (int f = 0; f < mesh_.face_count(); ++f)
      if (mesh_.has_face(f) && name[index(mesh_.from(3 * f))] >= 0)
        for (int k = 0; k < 3; ++k) corners.push_back(name[index(mesh_.from(3 * f + k))]);
    result.F = Eigen::Map<const Triangles>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3);
    if (new_vertex_of != nullptr) {
      new_vertex_of->assign(position_.size(), -1);
      for (std::size_t v = 0; v < position_.size(); ++v) {
        int u = static_cast<int>(v);
        while (merged_into_[index(u)] >= 0) u = merged_into_[index(u)];
        (*new_vertex_of)[v] = name[index(u)];
      }
    }
    return result;
  }

 private:
  const Vec3& at(int v) const { return position_[index(v)]; }
  std::uint32_t stamp_of(int a, int b) const {
    return (stamp_[index(a)] + stamp_[index(b)]) & ~CollapseCandidate::weighed_bit;
  }

  void gather_quadrics() {
    for (int f = 0; f < mesh_.face_count(); ++f) {
      const Vec3 &a = at(mesh_.from(3 * f)), &b = at(mesh_.from(3 * f + 1)), &c = at(mesh_.from(3 * f + 2));
      const Vec3 cross = (b - a).cross(c - a);
      const double twice_area = cross.norm();
      if (!(twice_area > 0)) continue;
      const Vec3 normal = cross / twice_area;
      const Quadric q = Quadric::plane((a + b + c) / 3, normal, normal_variance, twice_area / 6);
      for (int h = 3 * f; h < 3 * f + 3; ++h) {
        quadric_[index(mesh_.from(h))] += q;
        if (mesh_.opposite(h) >= 0) continue;
        // The plane through a boundary edge that stands on its face.
        const Vec3 &p = at(mesh_.from(h)), &r = at(mesh_.to(h)), along = r - p;
        const Vec3 across = along.cross(normal);
        if (!(across.norm() > 0)) continue;
        const Quadric side =
            Quadric::plane((p + r) / 2, across.normalized(), normal_variance, boundary_weight * along.squaredNorm());
        quadric_[index(mesh_.from(h))] += side;
        quadric_[index(mesh_.to(h))] += side;
      }
    }
  }

  /// Where the merged vertex goes. An end on the boundary stays when the other is inside.
  Vec3 placement(int a, int b, const Quadric& q) const {
    const bool boundary_a = mesh_.on_boundary(a), boundary_b = mesh_.on_boundary(b);
    if (boundary_a != boundary_b) return boundary_a ? at(a) : at(b);
    Vec3 p;
    if (q.minimiser(p)) return p;
    const Vec3 middle = 0.5 * (at(a) + at(b));
    return q(middle) <= std::min(q(at(a)), q(at(b))) ? middle : q(at(a)) <= q(at(b)) ? at(a) : at(b);
  }

  void enqueue(int a, int b) {
    const Quadric q = quadric_[index(a)] + quadric_[index(b)];
    const double cost = std::max(0.0, q(placement(a, b, q)));
    queue_.push({static_cast<float>(cost), stamp_of(a, b), std::min(a, b), std::max(a, b)});
  }

  /// The worst shape among the faces that would stay around the edge, with its vertex at p; negative
  /// when one of them would turn over. `before` gets the worst shape now.
  double worst_shape(int a, int b, const Vec3& p, double& before) const {
    double worst = 1;
    before = 1;
    bool turns = false;
    const auto look = [&](int moving, int other) {
      mesh_.around(moving, [&](int h) {
        const int u = mesh_.to(h), w = mesh_.apex(h);
        const Vec3 &q = at(u), &r = at(w), &old = at(moving);
        const Vec3 was = (q - old).cross(r - old);
        before = std::min(before, triangle_shape(old, q, r, was));
        if (u == other || w == other) return;
        const Vec3 is = (q - p).cross(r - p);
        if (!(was.dot(is) >= min_turn_cosine * std::sqrt(was.squaredNorm() * is.squaredNorm()))) turns = true;
        worst = std::min(worst, triangle_shape(p, q, r, is));
      });
    };
    look(a, b);
    look(b, a);
    return turns ? -1 : worst;
  }

  void consider(const CollapseCandidate& candidate) {
    int h = mesh_.find(candidate.a, candidate.b);
    if (h < 0) h = mesh_.find(candidate.b, candidate.a);
    if (h < 0 || !mesh_.may_collapse(h)) return;
    const int a = mesh_.from(h), b = mesh_.to(h);
    const Quadric q = quadric_[index(a)] + quadric_[index(b)];
    Vec3 p = placement(a, b, q);
    double before = 0, worst = worst_shape(a, b, p, before);
    if (worst < 0 && mesh_.on_boundary(a) == mesh_.on_boundary(b)) {
      for (const Vec3& other : {Vec3(0.5 * (at(a) + at(b))), at(a), at(b)}) {
        worst = worst_shape(a, b, other, before);
        p = other;
        if (worst >= 0) break;
      }
    }
    // Refused edges come back by themselves when something next to them changes.
    if (worst < 0 || (worst < min_shape && worst < before)) return;
    if (worst < fair_shape && worst < before && (candidate.stamp & CollapseCandidate::weighed_bit) == 0) {
      const double factor = fair_shape / worst;
      CollapseCandidate weighed = candidate;
      weighed.cost = static_cast<float>(std::min(static_cast<double>(candidate.cost) * factor * factor, 1e30));
      weighed.stamp |= CollapseCandidate::weighed_bit;
      if (weighed.cost > queue_.cheapest()) {
        queue_.push(weighed);
        return;
      }
    }
    last_cost_ = static_cast<double>(candidate.cost);
    mesh_.collapse(h);
    position_[index(a)] = p;
    quadric_[index(a)] = q;
    stamp_[index(a)] += stamp_[index(b)] + 1;
    merged_into_[index(b)] = a;
    --vertices_;
    mesh_.neighbours(a, [&](int u) { enqueue(a, u); });
  }

  CollapsibleMesh mesh_;
  Vec3 centre_;
  double scale_ = 1;
  std::vector<Vec3> position_;
  std::vector<Quadric> quadric_;
  std::vector<std::uint32_t> stamp_;  // grows with every change of a vertex
  std::vector<int> merged_into_;      // -1 for none, -2 for dropped
  int vertices_ = 0;
  double last_cost_ = 0;  // of a collapse
  Queue queue_;
};

}  // namespace

TriangleMesh simplify(const TriangleMesh& mesh, const SimplifyOptions& options, Context& context,
                      std::vector<int>* new_vertex_of) {
  if (options.target_vertices < 4)
    throw Error(ErrorCode::invalid_input, "target_vertices",
                "A surface needs at least 4 vertices: raise the number of vertices.");
  context.progress(0, "Simplifying");
  if (mesh.vertex_count() <= options.target_vertices) {
    if (new_vertex_of != nullptr) {
      new_vertex_of->resize(index(mesh.vertex_count()));
      for (int v = 0; v < mesh.vertex_count(); ++v) (*new_vertex_of)[index(v)] = v;
    }
    return mesh;
  }
  if (!mesh.V.allFinite())
    throw Error(ErrorCode::invalid_input, "mesh", "The mesh has corners that are not numbers; repair it first.");
  const Adjacency adjacency(mesh);
  if (!adjacency.is_manifold())
    throw Error(ErrorCode::invalid_input, "mesh",
                "The mesh is not manifold or its triangles face different ways; repair it first.");
  Simplifier simplifier(mesh, adjacency);
  if (options.drop_small_parts) simplifier.drop_small_parts(mesh, adjacency, options.target_vertices);
  {
    const auto span = context.span(0.1, 0.95, "Simplifying");
    simplifier.collapse_to(options.target_vertices, context);
  }
  simplifier.improve(context);
  context.progress(1);
  return simplifier.extract(new_vertex_of);
}

}  // namespace formwright
