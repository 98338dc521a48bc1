// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/zipping/cloth_energy.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "geometry/mesh/adjacency.h"

namespace formwright {
namespace {

using Map = Eigen::Matrix<double, 3, 2>;

Map deformation(const ClothTriangle& t, const Positions& x) {
  Map f = Map::Zero();
  for (int k = 0; k < 3; ++k) f += x.row(t.vertex[static_cast<std::size_t>(k)]).transpose() * t.gradient.row(k);
  return f;
}

/// Membrane force per length over the rest shape, from the Green strain.
Eigen::Matrix2d stress(const ClothMaterial& m, const Eigen::Matrix2d& strain) {
  const double factor = m.stretch_n_per_mm / (1 - m.poisson_ratio * m.poisson_ratio);
  return factor * ((1 - m.poisson_ratio) * strain + m.poisson_ratio * strain.trace() * Eigen::Matrix2d::Identity());
}

/// Eigenvalues of a symmetric matrix, the larger first.
std::array<double, 2> eigenvalues(const Eigen::Matrix2d& s) {
  const double mean = 0.5 * (s(0, 0) + s(1, 1)), radius = std::hypot(0.5 * (s(0, 0) - s(1, 1)), s(0, 1));
  return {mean + radius, mean - radius};
}

Eigen::Matrix2d without_pushing(const Eigen::Matrix2d& s) {
  const auto [high, low] = eigenvalues(s);
  if (low >= 0) return s;
  if (high <= 0) return Eigen::Matrix2d::Zero();
  return high / (high - low) * (s - low * Eigen::Matrix2d::Identity());
}

double cotangent(const Vec3& u, const Vec3& v) { return u.dot(v) / u.cross(v).norm(); }

}  // namespace

std::vector<ClothTriangle> cloth_triangles(const TriangleMesh& flat) {
  std::vector<ClothTriangle> triangles;
  triangles.reserve(static_cast<std::size_t>(flat.F.rows()));
  for (Eigen::Index f = 0; f < flat.F.rows(); ++f) {
    ClothTriangle t;
    std::array<Vec2, 3> p;
    for (std::size_t k = 0; k < 3; ++k) {
      t.vertex[k] = flat.F(f, static_cast<Eigen::Index>(k));
      p[k] = flat.V.row(t.vertex[k]).head<2>();
    }
    const double twice = (p[1] - p[0]).x() * (p[2] - p[0]).y() - (p[1] - p[0]).y() * (p[2] - p[0]).x();
    t.area_mm2 = 0.5 * twice;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2 side = p[(k + 2) % 3] - p[(k + 1) % 3];
      t.gradient.row(static_cast<Eigen::Index>(k)) = Vec2(-side.y(), side.x()) / twice;
    }
    triangles.push_back(t);
  }
  return triangles;
}

std::vector<ClothHinge> cloth_hinges(const TriangleMesh& flat, double bending_n_mm) {
  const Adjacency adjacency(flat);
  std::vector<ClothHinge> hinges;
  for (int h = 0; h < 3 * adjacency.face_count(); ++h) {
    const int other = adjacency.opposite(h);
    if (other <= h) continue;
    ClothHinge hinge;
    hinge.vertex = {adjacency.from(h), adjacency.to(h), adjacency.from(previous_halfedge(h)),
                    adjacency.from(previous_halfedge(other))};
    std::array<Vec3, 4> p;
    for (std::size_t k = 0; k < 4; ++k) p[k] = flat.V.row(hinge.vertex[k]);
    const Vec3 edge = p[1] - p[0];
    const double at0_left = cotangent(edge, p[2] - p[0]), at0_right = cotangent(edge, p[3] - p[0]),
                 at1_left = cotangent(-edge, p[2] - p[1]), at1_right = cotangent(-edge, p[3] - p[1]);
    hinge.weight << at1_left + at1_right, at0_left + at0_right, -at0_left - at1_left, -at0_right - at1_right;
    const double areas = 0.5 * (edge.cross(p[2] - p[0]).norm() + edge.cross(p[3] - p[0]).norm());
    hinge.stiffness_n_per_mm = bending_n_mm / areas;
    hinges.push_back(hinge);
  }
  return hinges;
}

double stretch_energy_mj(const ClothTriangle& t, const ClothMaterial& material, const Positions& x) {
  const Map f = deformation(t, x);
  const Eigen::Matrix2d strain = 0.5 * (f.transpose() * f - Eigen::Matrix2d::Identity());
  return 0.5 * t.area_mm2 * stress(material, strain).cwiseProduct(strain).sum();
}

void stretch_terms(const ClothTriangle& t, const ClothMaterial& material, const Positions& x, StretchTerms& terms,
                   bool whole) {
  const Map f = deformation(t, x);
  const Eigen::Matrix2d strain = 0.5 * (f.transpose() * f - Eigen::Matrix2d::Identity());
  const Eigen::Matrix2d s = stress(material, strain), pulling = whole ? s : without_pushing(s);
  terms.energy_mj = 0.5 * t.area_mm2 * s.cwiseProduct(strain).sum();
  const Map force = t.area_mm2 * f * s;
  // Strain components e11, e22, 2 e12 change by B, one 3 x 3 matrix a corner.
  std::array<Eigen::Matrix3d, 3> B, DB;
  const double nu = material.poisson_ratio, factor = t.area_mm2 * material.stretch_n_per_mm / (1 - nu * nu);
  Eigen::Matrix3d D;
  D << 1, nu, 0, nu, 1, 0, 0, 0, 0.5 * (1 - nu);
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::RowVector2d g = t.gradient.row(static_cast<Eigen::Index>(k));
    terms.gradient[k] = force * g.transpose();
    B[k].row(0) = g[0] * f.col(0).transpose();
    B[k].row(1) = g[1] * f.col(1).transpose();
    B[k].row(2) = g[0] * f.col(1).transpose() + g[1] * f.col(0).transpose();
    DB[k] = factor * D * B[k];
  }
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      const double along = t.area_mm2 * t.gradient.row(static_cast<Eigen::Index>(i))
                                            .dot(pulling * t.gradient.row(static_cast<Eigen::Index>(j)).transpose());
      terms.block[i][j] = B[i].transpose() * DB[j];
      terms.block[i][j].diagonal().array() += along;
    }
}

double largest_strain(const ClothTriangle& t, const Positions& x) {
  const Map f = deformation(t, x);
  const auto [high, low] = eigenvalues(f.transpose() * f);
  return std::max(std::abs(std::sqrt(high) - 1), std::abs(std::sqrt(std::max(low, 0.0)) - 1));
}

double bending_energy_mj(const std::vector<ClothHinge>& hinges, const Positions& x) {
  double sum = 0;
  for (const ClothHinge& hinge : hinges) sum += 0.5 * hinge.stiffness_n_per_mm * bending_vector(hinge, x).squaredNorm();
  return sum;
}

}  // namespace formwright
