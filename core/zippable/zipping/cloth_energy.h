// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Flat cloth: stretching of linear triangles from their flat rest shape (St. Venant-Kirchhoff, plane stress) and
// bending with zero rest angle, quadratic in the positions because the cloth hardly stretches: Bergou, Wardetzky,
// Harmon, Zorin, Grinspun 2006, "A Quadratic Bending Model for Inextensible Surfaces".
//
// The paper's factor 3 is left out: a cylinder of curvature k then has the plate's D k^2 / 2 an area on equilateral
// triangles and on strips along its rulings alike, which are what a ribbon consists of.
#include <Eigen/Core>
#include <array>
#include <vector>

#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

struct ClothMaterial {
  double stretch_n_per_mm = 10;  // Young's modulus times thickness
  double poisson_ratio = 0.3;
  double bending_n_mm = 0.2;        // D: energy D k^2 / 2 an area of a cylinder of curvature k
  double zipper_bending_n_mm2 = 0;  // B: energy B k^2 / 2 a length of zipper
};

struct ClothTriangle {
  std::array<int, 3> vertex{};
  Eigen::Matrix<double, 3, 2> gradient;  // of the hat functions in the flat cloth, 1/mm
  double area_mm2 = 0;
};

struct ClothHinge {
  std::array<int, 4> vertex{};    // the edge's ends, then the corners opposite
  Eigen::Vector4d weight;         // bending vector: sum of weight times position, zero where flat
  double stiffness_n_per_mm = 0;  // energy: half of it times the squared bending vector
};

/// Energy of one triangle with its derivatives by the corners' positions. `block` [i][j] for j <= i only.
struct StretchTerms {
  double energy_mj = 0;
  std::array<Vec3, 3> gradient;  // N
  std::array<std::array<Eigen::Matrix3d, 3>, 3> block;
};

/// `flat`: z is ignored, triangles are positively oriented and have area.
std::vector<ClothTriangle> cloth_triangles(const TriangleMesh& flat);
std::vector<ClothHinge> cloth_hinges(const TriangleMesh& flat, double bending_n_mm);

double stretch_energy_mj(const ClothTriangle& triangle, const ClothMaterial& material, const Positions& x);
/// Unless `whole`, the Hessian is made positive semidefinite: of the stress, what pushes is left out of it.
void stretch_terms(const ClothTriangle& triangle, const ClothMaterial& material, const Positions& x,
                   StretchTerms& terms, bool whole = false);

/// Largest principal strain by amount, of lengths: 0.01 where a line got a hundredth longer or shorter.
double largest_strain(const ClothTriangle& triangle, const Positions& x);

inline Vec3 bending_vector(const ClothHinge& hinge, const Positions& x) {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < 4; ++k) sum += hinge.weight[k] * x.row(hinge.vertex[static_cast<std::size_t>(k)]).transpose();
  return sum;
}
double bending_energy_mj(const std::vector<ClothHinge>& hinges, const Positions& x);

}  // namespace formwright
