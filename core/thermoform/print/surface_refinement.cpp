// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/print/surface_refinement.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/mesh/adjacency.h"

namespace formwright {
namespace {

constexpr double rounding_mm = 1e-6;

/// The working list of triangles; new vertices are weights of the old face's corners as well as positions.
class Refiner {
 public:
  Refiner(const TriangleMesh& mesh, Context& context) : context_(context) {
    V_.reserve(static_cast<std::size_t>(mesh.vertex_count()));
    for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
      V_.push_back(mesh.V.row(i));
      if (std::abs(V_.back().z()) < rounding_mm) V_.back().z() = 0;  // no slivers where the model stands on the plate
    }
    for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
      faces_.push_back({{mesh.F(f, 0), mesh.F(f, 1), mesh.F(f, 2)},
                        static_cast<int>(f),
                        {Eigen::Vector2f(0, 0), Eigen::Vector2f(1, 0), Eigen::Vector2f(0, 1)}});
  }

  /// Splits every edge that passes through z = 0.
  void cut_at_plate() {
    split(
        [&](const Vec3& a, const Vec3& b, double& t) {
          if (!((a.z() < 0 && b.z() > 0) || (a.z() > 0 && b.z() < 0))) return false;
          t = a.z() / (a.z() - b.z());
          return true;
        },
        true);
  }

  /// One pass of bisection; false when there was nothing left to do, or no room for it.
  bool bisect(double longest_mm, int max_triangles) {
    const double squared = longest_mm * longest_mm;
    std::size_t added = 0;
    for (const Face& face : faces_)
      for (std::size_t k = 0; k < 3 && !is_below(face); ++k)
        if ((at(face.v[k]) - at(face.v[(k + 1) % 3])).squaredNorm() > squared) ++added;
    if (added == 0 || faces_.size() + added > static_cast<std::size_t>(max_triangles)) return false;
    split(
        [&](const Vec3& a, const Vec3& b, double& t) {
          t = 0.5;
          return (a - b).squaredNorm() > squared;
        },
        false);
    return true;
  }

  RefinedSurface result() const {
    RefinedSurface refined;
    refined.mesh.V.resize(static_cast<Eigen::Index>(V_.size()), 3);
    for (std::size_t i = 0; i < V_.size(); ++i) refined.mesh.V.row(static_cast<Eigen::Index>(i)) = V_[i].transpose();
    refined.mesh.F.resize(static_cast<Eigen::Index>(faces_.size()), 3);
    double squared = 0;
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      const Face& face = faces_[f];
      for (std::size_t k = 0; k < 3; ++k)
        refined.mesh.F(static_cast<Eigen::Index>(f), static_cast<Eigen::Index>(k)) = face.v[k];
      refined.face_of.push_back(face.origin);
      refined.place.push_back(face.place);
      refined.below_plate.push_back(is_below(face));
      for (std::size_t k = 0; k < 3 && !is_below(face); ++k)
        squared = std::max(squared, (at(face.v[k]) - at(face.v[(k + 1) % 3])).squaredNorm());
    }
    refined.edge_mm = std::sqrt(squared);
    return refined;
  }

 private:
  struct Face {
    std::array<int, 3> v;
    int origin;
    std::array<Eigen::Vector2f, 3> place;
  };

  const Vec3& at(int v) const { return V_[static_cast<std::size_t>(v)]; }
  /// In the plate or under it: nothing above, and where it stands on the plate it looks down.
  bool is_below(const Face& face) const {
    const Vec3 &a = at(face.v[0]), &b = at(face.v[1]), &c = at(face.v[2]);
    const double top = std::max({a.z(), b.z(), c.z()});
    return top <= 0 || (top <= plate_contact_mm && (b - a).cross(c - a).z() < 0);
  }

  /// Gives every edge (a, b) for which wants(a, b, t) a vertex at a + t (b - a) and re-divides the faces.
  template <class Wants>
  void split(const Wants& wants, bool onto_plate) {
    context_.check_cancelled();
    TriangleMesh now;
    now.V.resize(static_cast<Eigen::Index>(V_.size()), 3);  // only counted
    now.F.resize(static_cast<Eigen::Index>(faces_.size()), 3);
    for (std::size_t f = 0; f < faces_.size(); ++f)
      for (std::size_t k = 0; k < 3; ++k)
        now.F(static_cast<Eigen::Index>(f), static_cast<Eigen::Index>(k)) = faces_[f].v[k];
    const Adjacency adjacency(now);
    context_.check_cancelled();
    std::vector<int> middle(static_cast<std::size_t>(adjacency.edge_count()), -1);
    std::vector<double> weight(middle.size(), 0);
    for (std::size_t e = 0; e < middle.size(); ++e) {
      const Edge edge = adjacency.edges()[e];
      const bool above = std::ranges::any_of(adjacency.halfedges_of_edge(static_cast<int>(e)), [&](int h) {
        return onto_plate || !is_below(faces_[static_cast<std::size_t>(h / 3)]);
      });
      if (double t = 0; above && wants(at(edge.lower), at(edge.higher), t)) {
        middle[e] = static_cast<int>(V_.size());
        weight[e] = t;
        Vec3 point = at(edge.lower) + t * (at(edge.higher) - at(edge.lower));
        if (onto_plate) point.z() = 0;
        V_.push_back(point);
      }
    }
    std::vector<Face> old;
    old.swap(faces_);
    for (std::size_t f = 0; f < old.size(); ++f) {
      const Face& face = old[f];
      std::array<int, 3> m{};
      std::array<Eigen::Vector2f, 3> place{};
      int count = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto e = static_cast<std::size_t>(adjacency.edge_of(static_cast<int>(3 * f + k)));
        m[k] = middle[e];
        if (m[k] < 0) continue;
        ++count;
        const bool forward = face.v[k] == adjacency.edges()[e].lower;
        const auto t = static_cast<float>(forward ? weight[e] : 1 - weight[e]);
        place[k] = face.place[k] + t * (face.place[(k + 1) % 3] - face.place[k]);
      }
      divide(face, m, place, count);
    }
  }

  void divide(const Face& face, const std::array<int, 3>& m, const std::array<Eigen::Vector2f, 3>& place, int count) {
    const auto add = [&](int a, int b, int c, const Eigen::Vector2f& pa, const Eigen::Vector2f& pb,
                         const Eigen::Vector2f& pc) {
      faces_.push_back({{a, b, c}, face.origin, {pa, pb, pc}});
    };
    if (count == 0) {
      faces_.push_back(face);
      return;
    }
    if (count == 3) {
      for (std::size_t k = 0; k < 3; ++k)
        add(face.v[k], m[k], m[(k + 2) % 3], face.place[k], place[k], place[(k + 2) % 3]);
      add(m[0], m[1], m[2], place[0], place[1], place[2]);
      return;
    }
    if (count == 1) {
      const std::size_t k = m[0] >= 0 ? 0 : m[1] >= 0 ? 1 : 2, b = (k + 1) % 3, c = (k + 2) % 3;
      add(face.v[k], m[k], face.v[c], face.place[k], place[k], face.place[c]);
      add(m[k], face.v[b], face.v[c], place[k], face.place[b], face.place[c]);
      return;
    }
    // Two split edges meet in corner a; the quadrilateral that is left is cut along its shorter diagonal.
    const std::size_t a = m[0] < 0 ? 2 : m[1] < 0 ? 0 : 1;  // the corner opposite to the whole edge
    const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
    const int mb = m[a], mc = m[c];
    add(face.v[a], mb, mc, face.place[a], place[a], place[c]);
    const double one = (at(mb) - at(face.v[c])).squaredNorm(), other = (at(mc) - at(face.v[b])).squaredNorm();
    if (one <= other) {
      add(mb, face.v[b], face.v[c], place[a], face.place[b], face.place[c]);
      add(mb, face.v[c], mc, place[a], face.place[c], place[c]);
    } else {
      add(mb, face.v[b], mc, place[a], face.place[b], place[c]);
      add(face.v[b], face.v[c], mc, face.place[b], face.place[c], place[c]);
    }
  }

  Context& context_;
  std::vector<Vec3> V_;
  std::vector<Face> faces_;
};

}  // namespace

RefinedSurface refine_above_plate(const TriangleMesh& mesh, double longest_edge_mm, int max_triangles,
                                  Context& context) {
  Refiner refiner(mesh, context);
  refiner.cut_at_plate();
  while (refiner.bisect(longest_edge_mm, max_triangles)) {}
  RefinedSurface refined = refiner.result();
  refined.undivided = mesh;
  return refined;
}

}  // namespace formwright
