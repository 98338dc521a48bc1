// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Ridges, valleys and sharp edges of a surface: where it bends across a line by more than around it.
//
// Every edge bends the surface by its dihedral angle, across its own direction (the curvature tensor of Cohen-Steiner &
// Morvan 2003). That is averaged over a small scale and over one four times as large, by a step of implicit diffusion
// each; their difference vanishes on spheres and cylinders of any radius. Thesis Sec. 5.5 names features as what the
// zipper's curve should follow.
#include <vector>

#include "base/context.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

struct FeatureOptions {
  double scale_mm = 2;    // how far a crease may be rounded off and still be one
  double min_rad = 0.35;  // how much the surface bends across it at least, within about that scale
};

/// A vertex on a feature line: the bend is largest there, across the line.
struct FeaturePoint {
  int vertex = 0;
  Vec3 along;           // unit tangent of the line, of either sign
  double bend_rad = 0;  // positive on ridges, negative in valleys
};

struct FeatureLines {
  FeatureOptions options;
  Eigen::VectorXd bend_rad;    // per edge of the mesh's adjacency, along that edge; positive on ridges, negative in
                               // valleys; largest on the line
  std::vector<char> sharp;     // per edge: bent by the least angle in itself
  Eigen::VectorXd valley_rad;  // per vertex: how much it bends inwards across whichever direction, 0 or more
  std::vector<FeaturePoint> points;  // ascending by vertex
};

/// Twice the mean edge or a tenth of the ribbon's width, whichever is more; `given_mm` where it is above 0.
double feature_scale_mm(const TriangleMesh& mesh, double width_mm, double given_mm);

/// Needs an edge-manifold, oriented mesh. Throws Error: cancelled.
FeatureLines find_features(const TriangleMesh& mesh, const Adjacency& adjacency, const FeatureOptions& options,
                           Context& context);

}  // namespace formwright
