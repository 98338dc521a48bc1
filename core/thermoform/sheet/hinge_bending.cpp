// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/sheet/hinge_bending.h"

#include <Eigen/Dense>
#include <cmath>

#include "geometry/mesh/adjacency.h"

namespace formwright {

double hinge_angle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, std::array<Vec3, 4>* gradient) {
  const Vec3 edge = b - a;
  const Vec3 n0 = edge.cross(c - a), n1 = (d - a).cross(edge);  // twice the area vectors
  const double length = std::max(edge.norm(), 1e-12);
  const double squared0 = std::max(n0.squaredNorm(), 1e-24), squared1 = std::max(n1.squaredNorm(), 1e-24);
  const double angle = std::atan2(n0.cross(n1).dot(edge) / length, n0.dot(n1));
  if (gradient) {
    // Moving a wing's tip along its normal turns it about the edge; the edge's ends share the reaction by levers.
    const Vec3 tip0 = -length / squared0 * n0, tip1 = -length / squared1 * n1;
    const double c_at = (c - a).dot(edge) / (length * length), d_at = (d - a).dot(edge) / (length * length);
    (*gradient)[2] = tip0;
    (*gradient)[3] = tip1;
    (*gradient)[0] = -(1 - c_at) * tip0 - (1 - d_at) * tip1;
    (*gradient)[1] = -c_at * tip0 - d_at * tip1;
  }
  return angle;
}

HingeBending::HingeBending(const Triangles& F, int vertex_count, double young_mpa, double poisson_ratio,
                           double viscosity_s)
    : modulus_(young_mpa / (12 * (1 - poisson_ratio * poisson_ratio))), viscosity_s_(viscosity_s) {
  TriangleMesh mesh;
  mesh.V = Positions::Zero(vertex_count, 3);
  mesh.F = F;
  const Adjacency adjacency(mesh);
  for (int h = 0; h < 3 * adjacency.face_count(); ++h) {
    const int other = adjacency.opposite(h);
    if (other <= h) continue;
    const Hinge hinge{{adjacency.from(h), adjacency.to(h), adjacency.from(previous_halfedge(h)),
                       adjacency.from(previous_halfedge(other))},
                      {h / 3, other / 3},
                      0,
                      0};
    hinges_.push_back(hinge);
    vertices_.insert(vertices_.end(), hinge.vertex.begin(), hinge.vertex.end());
  }
}

void HingeBending::begin_step(const Positions& x, std::span<const double> thickness_mm,
                              std::span<const double> stiffness_factor, bool keep_rest_angles) {
  for (Hinge& hinge : hinges_) {
    const Vec3 a = x.row(hinge.vertex[0]), b = x.row(hinge.vertex[1]), c = x.row(hinge.vertex[2]),
               d = x.row(hinge.vertex[3]);
    const double thickness = 0.5 * (thickness_mm[static_cast<std::size_t>(hinge.face[0])] +
                                    thickness_mm[static_cast<std::size_t>(hinge.face[1])]);
    const double areas = 0.5 * ((b - a).cross(c - a).norm() + (b - a).cross(d - a).norm());
    const double factor = 0.5 * (stiffness_factor[static_cast<std::size_t>(hinge.face[0])] +
                                 stiffness_factor[static_cast<std::size_t>(hinge.face[1])]);
    hinge.stiffness =
        factor * modulus_ * thickness * thickness * thickness * 0.5 * (b - a).squaredNorm() / std::max(areas, 1e-12);
    if (!keep_rest_angles) hinge.rest_angle = hinge_angle(a, b, c, d, nullptr);
  }
}

std::vector<double> HingeBending::stiffness_mj() const {
  std::vector<double> result;
  for (const Hinge& hinge : hinges_) result.push_back(hinge.stiffness);
  return result;
}

double HingeBending::energy(const Positions& x, double dt_s) const {
  double sum = 0;
  for (const Hinge& hinge : hinges_) {
    const double bent = hinge_angle(x.row(hinge.vertex[0]), x.row(hinge.vertex[1]), x.row(hinge.vertex[2]),
                                    x.row(hinge.vertex[3]), nullptr) -
                        hinge.rest_angle;
    sum += hinge.stiffness * bent * bent;
  }
  return sum * (1 + viscosity_s_ / dt_s);
}

void HingeBending::add_forces(const Positions& x, double dt_s, Positions& force, BlockMatrix* matrix) const {
  const double factor = 2 * (1 + viscosity_s_ / dt_s);
  std::array<Vec3, 4> gradient;
  for (const Hinge& hinge : hinges_) {
    const double bent = hinge_angle(x.row(hinge.vertex[0]), x.row(hinge.vertex[1]), x.row(hinge.vertex[2]),
                                    x.row(hinge.vertex[3]), &gradient) -
                        hinge.rest_angle;
    for (std::size_t i = 0; i < 4; ++i) {
      force.row(hinge.vertex[i]) -= factor * hinge.stiffness * bent * gradient[i].transpose();
      if (!matrix) continue;
      for (std::size_t j = 0; j < 4; ++j) {  // Gauss-Newton: the angle's own curvature is left out
        auto& block = matrix->block(matrix->slot(hinge.vertex[i], hinge.vertex[j]));
        for (int k = 0; k < 3; ++k) {
          const Vec3 column = factor * hinge.stiffness * gradient[j][k] * gradient[i];
          block[static_cast<std::size_t>(k)] +=
              Float4{static_cast<float>(column.x()), static_cast<float>(column.y()), static_cast<float>(column.z()), 0};
        }
      }
    }
  }
}

}  // namespace formwright
