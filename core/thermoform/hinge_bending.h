// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Bending by the angles between neighbouring triangles: thesis 4.2.2, E_b (Batty et al. 2012; Grinspun et al. 2003).
#include <array>
#include <span>
#include <vector>

#include "thermoform/block_matrix.h"
#include "thermoform/membrane.h"

namespace formwright {

class HingeBending {
 public:
  /// Hinges at the interior edges of `F`. Young's modulus in MPa.
  HingeBending(const Triangles& F, int vertex_count, double young_mpa, double poisson_ratio, double viscosity_s);

  /// Four vertices a hinge: the edge's two, then the one opposite on either side. For the matrix's pattern.
  const std::vector<int>& vertices() const { return vertices_; }

  /// Lengths, areas and the triangles' thickness (m, mm) at `x`; the rest angles become those at `x`, as the thesis does
  /// (unless `keep_rest_angles`).
  void begin_step(const Positions& x, std::span<const double> thickness_mm, bool keep_rest_angles = false);

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

/// Angle between the two triangles of a hinge, 0 when flat, positive when the edge stands out towards the normals' side, and its
/// gradient by the four vertices (edge from a to b, c left of it, d right of it).
double hinge_angle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, std::array<Vec3, 4>* gradient);

}  // namespace formwright
