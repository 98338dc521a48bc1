// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Bending by the angles between neighbouring triangles: thesis 4.2.2, E_b (Batty et al. 2012; Grinspun et al. 2003).
//
// As printed, sum D 3 l^2/A_s theta^2 is six times as stiff as a plate of bending stiffness D = Y h^3 / (12 (1 -
// nu^2)): on equilateral triangles a cylinder of curvature k gets 3 D k^2 an area instead of D k^2 / 2. Here the sum is
// divided by six, so that a clamped circular plate sags by q a^4 / (64 D), which the tests check.
#include <array>
#include <span>
#include <vector>

#include "thermoform/solver/block_matrix.h"
#include "thermoform/sheet/membrane.h"

namespace formwright {

class HingeBending {
 public:
  /// Hinges at the interior edges of `F`. Young's modulus in MPa.
  HingeBending(const Triangles& F, int vertex_count, double young_mpa, double poisson_ratio, double viscosity_s);

  /// Four vertices a hinge: the edge's two, then the one opposite on either side. For the matrix's pattern.
  const std::vector<int>& vertices() const { return vertices_; }

  /// Lengths, areas and the triangles' thickness (m, mm) at `x`; the rest angles become those at `x`, as the thesis
  /// does (unless `keep_rest_angles`). `stiffness_factor`: of each triangle (m).
  void begin_step(const Positions& x, std::span<const double> thickness_mm, std::span<const double> stiffness_factor,
                  bool keep_rest_angles = false);

  /// mJ, one a hinge in the order of vertices(): E_b = sum stiffness (theta - rest angle)^2.
  std::vector<double> stiffness_mj() const;

  /// E_b (1 + o/dt) in mJ: elastic and viscous part count from the same angles.
  double energy(const Positions& x, double dt_s) const;
  void add_forces(const Positions& x, double dt_s, Positions& force, BlockMatrix* matrix) const;

 private:
  struct Hinge {
    std::array<int, 4> vertex;
    std::array<int, 2> face;
    double stiffness = 0, rest_angle = 0;  // mJ; radians
  };
  std::vector<Hinge> hinges_;
  std::vector<int> vertices_;
  double modulus_, viscosity_s_;
};

/// Angle between the two triangles of a hinge, 0 when flat, positive when the edge stands out towards the normals'
/// side, and its gradient by the four vertices (edge from a to b, c left of it, d right of it).
double hinge_angle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, std::array<Vec3, 4>* gradient);

}  // namespace formwright
