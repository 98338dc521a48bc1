// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/measures.h"

#include <cmath>

namespace formwright {
namespace {

/// Twice the area vector of face f.
Vec3 area_vector(const TriangleMesh& mesh, int f) {
  const Vec3 a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)), c = mesh.V.row(mesh.F(f, 2));
  return (b - a).cross(c - a);
}

/// Unit length, or zero where there is no direction. Scaled first: squaring may over- or underflow.
Vec3 unit_or_zero(const Vec3& vector) {
  const double scale = vector.cwiseAbs().maxCoeff();
  if (!(scale > 0) || !std::isfinite(scale)) return Vec3::Zero();
  const Vec3 scaled = vector / scale;
  return scaled / scaled.norm();
}

}  // namespace

BoundingBox bounding_box(const TriangleMesh& mesh) {
  BoundingBox box;
  for (int v = 0; v < mesh.vertex_count(); ++v) box.add(mesh.V.row(v));
  return box;
}

Positions face_normals(const TriangleMesh& mesh) {
  Positions normals(mesh.face_count(), 3);
  for (int f = 0; f < mesh.face_count(); ++f) normals.row(f) = unit_or_zero(area_vector(mesh, f));
  return normals;
}

Eigen::VectorXd face_areas(const TriangleMesh& mesh) {
  Eigen::VectorXd areas(mesh.face_count());
  for (int f = 0; f < mesh.face_count(); ++f) areas[f] = 0.5 * area_vector(mesh, f).norm();
  return areas;
}

Positions vertex_normals(const TriangleMesh& mesh) {
  Positions normals = Positions::Zero(mesh.vertex_count(), 3);
  for (int f = 0; f < mesh.face_count(); ++f) {
    const Vec3 area = area_vector(mesh, f);
    for (int k = 0; k < 3; ++k) normals.row(mesh.F(f, k)) += area;
  }
  for (int v = 0; v < mesh.vertex_count(); ++v) normals.row(v) = unit_or_zero(normals.row(v));
  return normals;
}

double surface_area(const TriangleMesh& mesh) { return face_areas(mesh).sum(); }

double signed_volume(const TriangleMesh& mesh) {
  const Vec3 centre = bounding_box(mesh).centre();
  double six_volumes = 0;
  for (int f = 0; f < mesh.face_count(); ++f) {
    const Vec3 a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)), c = mesh.V.row(mesh.F(f, 2));
    six_volumes += (a - centre).dot((b - centre).cross(c - centre));
  }
  return six_volumes / 6;
}

double mean_edge_length(const TriangleMesh& mesh) {
  if (mesh.face_count() == 0) return 0;
  double sum = 0;
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k) sum += (mesh.V.row(mesh.F(f, k)) - mesh.V.row(mesh.F(f, (k + 1) % 3))).norm();
  return sum / (3.0 * mesh.face_count());
}

Positions corner_angles(const TriangleMesh& mesh) {
  Positions angles(mesh.face_count(), 3);
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k) {
      const Vec3 p = mesh.V.row(mesh.F(f, k));
      const Vec3 u = mesh.V.row(mesh.F(f, (k + 1) % 3)).transpose() - p;
      const Vec3 w = mesh.V.row(mesh.F(f, (k + 2) % 3)).transpose() - p;
      angles(f, k) = std::atan2(u.cross(w).norm(), u.dot(w));  // accurate for slivers; atan2(0, 0) = 0
    }
  return angles;
}

Eigen::VectorXd dihedral_angles(const TriangleMesh& mesh, const Adjacency& adjacency) {
  const Positions normals = face_normals(mesh);
  Eigen::VectorXd angles = Eigen::VectorXd::Zero(adjacency.edge_count());
  for (int e = 0; e < adjacency.edge_count(); ++e) {
    const int h = adjacency.halfedges_of_edge(e)[0], g = adjacency.opposite(h);
    if (g < 0) continue;
    const Vec3 n = normals.row(h / 3), m = normals.row(g / 3);
    const Vec3 along = unit_or_zero(mesh.V.row(adjacency.to(h)) - mesh.V.row(adjacency.from(h)));
    angles[e] = std::atan2(along.dot(n.cross(m)), n.dot(m));
  }
  return angles;
}

}  // namespace formwright
