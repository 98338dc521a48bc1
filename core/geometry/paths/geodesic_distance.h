// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Distance along the surface by fast marching: Kimmel & Sethian 1998. First order in the edge length.
#include <Eigen/Core>
#include <vector>

#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// Per vertex in mm, 0 at the sources, infinite where no source leads. Obtuse triangles fall back to their sides.
/// `slowness` (per vertex; empty: 1): what a millimetre there counts for.
Eigen::VectorXd geodesic_distance_mm(const TriangleMesh& mesh, const Adjacency& adjacency,
                                     const std::vector<int>& sources, const Eigen::VectorXd& slowness = {});

}  // namespace formwright
