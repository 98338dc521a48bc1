// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The cotangent Laplacian and vertex areas: Pinkall & Polthier 1993; Meyer, Desbrun, Schroeder, Barr
// 2003, "Discrete Differential-Geometry Operators for Triangulated 2-Manifolds".
//
// Sign: L is positive semidefinite, (L u)_i = sum_j w_ij (u_i - u_j), w_ij = (cot a_ij + cot b_ij) / 2,
// so L u / area approximates -Laplace(u), and u^T L u the Dirichlet energy of u.
#include <Eigen/SparseCore>

#include "geometry/mesh/adjacency.h"
#include "geometry/operators/intrinsic_delaunay.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

using SparseMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;

struct LaplacianOptions {
  /// Each cotangent is held within +-limit, so that a sliver cannot dominate; 20 is an angle of 2.9
  /// degrees. At most 1e12: then faces without area still give finite entries.
  double cotangent_limit = 20;
};

/// n x n, symmetric, both triangles stored; every diagonal entry is stored, also the zero of a vertex
/// without faces. Rows sum to 0. Edges with three or more faces sum all their cotangents.
SparseMatrix cotangent_laplacian(const TriangleMesh& mesh, const Adjacency& adjacency,
                                 const LaplacianOptions& options = {});
SparseMatrix cotangent_laplacian(const TriangleMesh& mesh, const LaplacianOptions& options = {});

/// On the same vertices, with the edges of an intrinsic Delaunay triangulation: w_ij >= 0 along every
/// inner edge, so that a maximum principle holds however poor the triangles (Bobenko & Springborn
/// 2007). Boundary edges, which no flip can improve, may still be negative.
SparseMatrix cotangent_laplacian(const IntrinsicTriangulation& triangulation, const LaplacianOptions& options = {});

enum class VertexArea {
  barycentric,    // a third of every adjacent face
  mixed_voronoi,  // circumcentric inside acute faces, halves and quarters of obtuse ones (Meyer et al., Fig. 4)
};

/// n, in mm^2. Their sum is the surface's area while no entry is raised to the floor, which is
/// `floor` times the mean over vertices that have faces; vertices without faces get the floor too.
Eigen::VectorXd vertex_areas(const TriangleMesh& mesh, VertexArea kind = VertexArea::mixed_voronoi,
                             double floor = 1e-3);
Eigen::VectorXd vertex_areas(const IntrinsicTriangulation& triangulation, VertexArea kind = VertexArea::mixed_voronoi,
                             double floor = 1e-3);

}  // namespace formwright
