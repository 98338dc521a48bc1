// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/triangle_improvement.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/index.h"

namespace formwright {
namespace {

constexpr int rounds = 5, flip_sweeps = 3;
/// How strongly the middle of the neighbours pulls against the planes, all of them together being 1. The planes of a
/// curved or sharp region resist, those of a flat one only across it.
constexpr double pull = 0.07;
/// Of the error that the caller allows: what one vertex may spend on better shapes.
constexpr double share_of_error = 0.7;
/// Faces at an edge that flips may meet under acos of this at most, and none of them may turn by more than that of the
/// other.
constexpr double flat_cosine = 0.85, turn_cosine = 0.8;

class Improver {
 public:
  Improver(CollapsibleMesh& mesh, std::vector<Vec3>& position, const std::vector<Quadric>& quadric,
           const std::vector<Freedom>& freedom, double max_error)
      : mesh_(mesh), position_(position), quadric_(quadric), freedom_(freedom), max_error_(max_error) {
    for (int f = 0; f < mesh.face_count(); ++f)
      if (mesh.has_face(f)) faces_.push_back(f);
    for (int v = 0; v < mesh.vertex_count(); ++v)
      if (mesh.has_vertex(v) && freedom[index(v)] == Freedom::move && !mesh.on_boundary(v)) movable_.push_back(v);
  }

  void run(const Context& context) {
    flip_edges(context);
    for (int round = 0; round < rounds; ++round) {
      for (std::size_t k = 0; k < movable_.size(); ++k) {
        if ((k & 0x3fff) == 0) context.check_cancelled();
        relax(movable_[k]);
      }
      flip_edges(context);
    }
  }

 private:
  const Vec3& at(int v) const { return position_[index(v)]; }
  bool fixed(int v) const { return freedom_[index(v)] == Freedom::none; }

  void flip_edges(const Context& context) {
    for (int sweep = 0; sweep < flip_sweeps; ++sweep) {
      int flips = 0;
      for (std::size_t k = 0; k < faces_.size(); ++k) {
        if ((k & 0x3fff) == 0) context.check_cancelled();
        for (int h = 3 * faces_[k]; h < 3 * faces_[k] + 3; ++h)
          if (mesh_.opposite(h) > h && worth_flipping(h)) {
            mesh_.flip(h);
            ++flips;
          }
      }
      if (flips == 0) break;
    }
  }

  bool worth_flipping(int h) const {
    const int g = mesh_.opposite(h), ia = mesh_.from(h), ib = mesh_.to(h), ic = mesh_.apex(h), id = mesh_.apex(g);
    if (fixed(ia) || fixed(ib) || fixed(ic) || fixed(id)) return false;
    const Vec3 &a = at(ia), &b = at(ib), &c = at(ic), &d = at(id);
    const Vec3 left = (b - a).cross(c - a), right = (a - b).cross(d - b);
    const double left_area = left.norm(), right_area = right.norm();
    if (!(left_area > 0 && right_area > 0) || left.dot(right) < flat_cosine * left_area * right_area) return false;
    const double cotangents = (a - c).dot(b - c) / left_area + (a - d).dot(b - d) / right_area;
    if (cotangents > -1e-6) return false;
    const Vec3 first = (c - d).cross(a - d), second = (d - c).cross(b - c),
               both = left + right;  // (d, c, a), (c, d, b)
    const double first_area = first.norm(), second_area = second.norm();
    if (first.dot(both) < turn_cosine * first_area * both.norm() ||
        second.dot(both) < turn_cosine * second_area * both.norm())
      return false;
    if (std::min(triangle_shape(d, c, a, first), triangle_shape(c, d, b, second)) <
        std::min(triangle_shape(a, b, c, left), triangle_shape(b, a, d, right)))
      return false;
    // Where the faces bend, the new edge must lie as near to the surface as the old one, within a little.
    if (left.dot(right) < 0.97 * left_area * right_area) {
      const Quadric all = (quadric_[index(ia)] + quadric_[index(ib)]) + (quadric_[index(ic)] + quadric_[index(id)]);
      const Vec3 here = 0.5 * (a + b), there = 0.5 * (c + d);
      if (all(there) > 1.2 * all(here)) return false;
    }
    return mesh_.may_flip(h);
  }

  /// The worst shape around v with v at p; negative when a face would turn over.
  double worst_shape(int v, const Vec3& p, bool compare) const {
    double worst = 1;
    mesh_.around(v, [&](int h) {
      const Vec3 &q = at(mesh_.to(h)), &r = at(mesh_.apex(h));
      const Vec3 is = (q - p).cross(r - p);
      if (compare) {
        const Vec3 was = (q - at(v)).cross(r - at(v));
        if (!(was.dot(is) > turn_cosine * std::sqrt(was.squaredNorm() * is.squaredNorm()))) worst = -1;
      }
      worst = std::min(worst, triangle_shape(p, q, r, is));
    });
    return worst;
  }

  void relax(int v) {
    // The centroid of the faces around, by area: evens out sizes as well as angles.
    Vec3 middle = Vec3::Zero();
    double total = 0;
    mesh_.around(v, [&](int h) {
      const Vec3 &q = at(mesh_.to(h)), &r = at(mesh_.apex(h));
      const double area = (q - at(v)).cross(r - at(v)).norm();
      middle += area / 3 * (at(v) + q + r);
      total += area;
    });
    if (!(total > 0)) return;
    middle /= total;
    Quadric q = quadric_[index(v)];
    const double weight = pull * (q.xx + q.yy + q.zz);
    q.xx += weight, q.yy += weight, q.zz += weight;
    q.x += weight * middle.x(), q.y += weight * middle.y(), q.z += weight * middle.z();
    Vec3 p;
    if (!q.minimiser(p)) return;
    // Once more from there: what the planes resist fades with the square, what they leave free stays.
    q.x += weight * (p.x() - middle.x()), q.y += weight * (p.y() - middle.y()), q.z += weight * (p.z() - middle.z());
    q.minimiser(p);
    const double before = worst_shape(v, at(v), false), allowed = std::max(max_error_, quadric_[index(v)](at(v)));
    for (int attempt = 0; attempt < 3; ++attempt, p = 0.5 * (p + at(v))) {
      if (quadric_[index(v)](p) > allowed) continue;
      const double after = worst_shape(v, p, true);
      if (after >= 0 && (after >= before || after > 0.7)) {
        position_[index(v)] = p;
        return;
      }
    }
  }

  CollapsibleMesh& mesh_;
  std::vector<Vec3>& position_;
  const std::vector<Quadric>& quadric_;
  const std::vector<Freedom>& freedom_;
  double max_error_;
  std::vector<int> faces_, movable_;
};

}  // namespace

double triangle_shape(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& cross) {
  const double sides = (b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm();
  return sides > 0 ? 2 * std::sqrt(3.0) * cross.norm() / sides : 0;
}

void improve_triangles(CollapsibleMesh& mesh, std::vector<Vec3>& position, const std::vector<Quadric>& quadric,
                       const std::vector<Freedom>& freedom, double max_error, const Context& context) {
  Improver(mesh, position, quadric, freedom, share_of_error * max_error).run(context);
}

}  // namespace formwright
