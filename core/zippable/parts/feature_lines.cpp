// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/parts/feature_lines.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/mesh/measures.h"
#include "numerics/sparse/sparse_cholesky.h"
#include "geometry/operators/nonnegative_laplacian.h"

namespace formwright {
namespace {

using Matrix3 = Eigen::Matrix3d;

constexpr double around = 4;  // the scale of what is around, in scales

/// Six columns: xx, yy, zz, xy, xz, yz of a symmetric tensor.
Matrix3 tensor(const Eigen::MatrixXd& columns, int v) {
  Matrix3 t;
  t << columns(v, 0), columns(v, 3), columns(v, 4), columns(v, 3), columns(v, 1), columns(v, 5), columns(v, 4),
      columns(v, 5), columns(v, 2);
  return t;
}

/// Sums at vertices, averaged over about a scale: (area + scale^2 L) u = sums. The factor's pattern is the same for
/// every scale.
class Averaging {
 public:
  Averaging(const Positions& places, const SparseMatrix& laplacian, const Eigen::VectorXd& area, Context& context)
      : laplacian_(laplacian), area_(area), context_(context) {
    cholesky_.analyze(lower(1), places, context);
  }

  Eigen::MatrixXd operator()(Eigen::MatrixXd sums, double scale_mm) {
    cholesky_.factorize(lower(scale_mm), context_);
    cholesky_.solve(sums);
    return sums;
  }

 private:
  SparseMatrix lower(double scale_mm) const {
    SparseMatrix system = scale_mm * scale_mm * laplacian_;
    for (int v = 0; v < system.rows(); ++v) system.coeffRef(v, v) += area_[v];
    return system.triangularView<Eigen::Lower>();
  }

  const SparseMatrix& laplacian_;
  const Eigen::VectorXd& area_;
  Context& context_;
  SparseCholesky cholesky_;
};

/// How much more it bends across d than along it, in radians; both within the tangent plane.
double bend_across(const Matrix3& t, const Vec3& d, const Vec3& normal) {
  const Vec3 p = normal.cross(d);
  return d.dot(t * d) - p.dot(t * p);
}

struct Bend {
  Vec3 along = Vec3::Zero();
  double rad = 0, valley_rad = 0;
};

/// The direction across which the surface bends most.
Bend greatest_bend(const Matrix3& t, const Vec3& normal) {
  Bend bend;
  if (normal.squaredNorm() < 0.5) return bend;
  const Vec3 a = normal.unitOrthogonal(), b = normal.cross(a);
  const double aa = a.dot(t * a), ab = a.dot(t * b), bb = b.dot(t * b);
  const double angle = 0.5 * std::atan2(2 * ab, aa - bb);
  const Vec3 first = std::cos(angle) * a + std::sin(angle) * b, second = normal.cross(first);
  const double along_first = first.dot(t * first), along_second = second.dot(t * second);
  bend.valley_rad = std::max({0.0, -along_first, -along_second});
  const bool is_first = std::abs(along_first) >= std::abs(along_second);
  bend.along = is_first ? first : second;
  bend.rad = is_first ? along_first - along_second : along_second - along_first;
  return bend;
}

}  // namespace

double feature_scale_mm(const TriangleMesh& mesh, double width_mm, double given_mm) {
  return given_mm > 0 ? given_mm : std::max(2 * mean_edge_length(mesh), 0.1 * width_mm);
}

FeatureLines find_features(const TriangleMesh& mesh, const Adjacency& adjacency, const FeatureOptions& options,
                           Context& context) {
  const int n = mesh.vertex_count();
  const Eigen::VectorXd dihedral = dihedral_angles(mesh, adjacency),
                        area = vertex_areas(mesh, VertexArea::barycentric, 1e-6);
  const Positions normals = vertex_normals(mesh);
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(n, 6);
  const auto along_edge = [&](int e) {
    return Vec3((mesh.V.row(adjacency.edges()[e].higher) - mesh.V.row(adjacency.edges()[e].lower)).transpose());
  };
  for (int e = 0; e < adjacency.edge_count(); ++e) {
    const Vec3 d = along_edge(e);
    const double length = d.norm();
    if (!(length > 0)) continue;
    const double share = 0.5 * dihedral[e] / length;
    for (const int v : {adjacency.edges()[e].lower, adjacency.edges()[e].higher})
      sums.row(v) += share * Eigen::Matrix<double, 1, 6>(d.x() * d.x(), d.y() * d.y(), d.z() * d.z(), d.x() * d.y(),
                                                         d.x() * d.z(), d.y() * d.z());
  }
  const SparseMatrix laplacian = nonnegative_laplacian(mesh, adjacency);
  // A straight crease bent by an angle comes out as that angle over twice the scale.
  Averaging averaged(mesh.V, laplacian, area, context);
  const Eigen::MatrixXd bends =
      2 * options.scale_mm * (averaged(sums, options.scale_mm) - averaged(sums, around * options.scale_mm));
  FeatureLines lines;
  lines.options = options;
  std::vector<Bend> greatest(n);
  lines.valley_rad.resize(n);
  for (int v = 0; v < n; ++v) {
    greatest[v] = greatest_bend(tensor(bends, v), normals.row(v).transpose());
    lines.valley_rad[v] = greatest[v].valley_rad;
  }
  lines.bend_rad = Eigen::VectorXd::Zero(adjacency.edge_count());
  lines.sharp.assign(adjacency.edge_count(), 0);
  for (int e = 0; e < adjacency.edge_count(); ++e) {
    const Vec3 d = along_edge(e).normalized();
    if (!(d.squaredNorm() > 0.5)) continue;
    const auto [a, b] = adjacency.edges()[e];
    const auto at = [&](int v) { return bend_across(tensor(bends, v), d, normals.row(v).transpose()); };
    double bend = 0.5 * (at(a) + at(b));
    // The tips of thin limbs have edges as bent as that, but in all directions.
    lines.sharp[e] =
        std::abs(dihedral[e]) >= options.min_rad && dihedral[e] * bend > 0 && std::abs(bend) >= 0.5 * options.min_rad;
    if (lines.sharp[e] && std::abs(dihedral[e]) > std::abs(bend)) bend = dihedral[e];
    lines.bend_rad[e] = bend;
  }
  for (int v = 0; v < n; ++v) {
    const Bend& own = greatest[v];
    if (std::abs(own.rad) < options.min_rad) continue;
    const Vec3 across = Vec3(normals.row(v).transpose()).cross(own.along);
    const auto outdone = [&](int w) {
      const Vec3 d = (mesh.V.row(w) - mesh.V.row(v)).transpose();
      return std::abs(d.dot(across)) > 0.7 * d.norm() && own.rad * greatest[w].rad > 0 &&
             std::abs(greatest[w].rad) > std::abs(own.rad);
    };
    const auto ring = adjacency.neighbours(v);
    if (std::none_of(ring.begin(), ring.end(), outdone)) lines.points.push_back({v, own.along, own.rad});
  }
  return lines;
}

}  // namespace formwright
