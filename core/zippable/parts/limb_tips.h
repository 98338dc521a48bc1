// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Where limbs end: maxima of the mean distance along the surface (Hilaga, Shinagawa, Kohmura, Kunii 2001).
#include <Eigen/Core>
#include <vector>

#include "base/context.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// Per vertex, the mean distance along the surface to everywhere else in mm, from a few vertices spread over it, each
/// standing for what is nearest to it. `mesh` is connected. Throws cancelled.
Eigen::VectorXd mean_distance_mm(const TriangleMesh& mesh, const Adjacency& adjacency, Context& context);

struct LimbTip {
  int vertex = 0;
  int saddle = -1;        // the vertex where its limb joins one with a higher tip; -1 where there is but one tip
  double prominence = 0;  // of `f`: tip above saddle
};

/// Maxima of `f` (per vertex) by persistence, the most prominent first: components of {f >= t} as t falls; the lower of
/// two that meet ends. At least the highest, and the others whose prominence is `minimum` or more. At least one vertex.
std::vector<LimbTip> prominent_maxima(const Adjacency& adjacency, const Eigen::VectorXd& f, double minimum);

}  // namespace formwright
