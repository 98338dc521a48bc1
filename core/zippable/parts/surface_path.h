// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Ways between points of a surface: along edges, and pulled straight.
#include <vector>

#include "geometry/mesh/adjacency.h"
#include "geometry/queries/point_distance.h"
#include "zippable/parts/feature_lines.h"

namespace formwright {

int nearest_vertex(const TriangleMesh& mesh, const Vec3& point);

/// Vertices of the shortest path along edges, both ends included; only the start where no path leads on. Edges along
/// `features` count for less.
std::vector<int> edge_path(const TriangleMesh& mesh, const Adjacency& adjacency, int from, int to,
                           const FeatureLines* features = nullptr);

/// Pulls a path straight on the surface: few points first, each to the middle between its neighbours and back onto the
/// surface, then twice as many, until they are `step_mm` apart. Ends stay.
std::vector<Vec3> straightened(std::vector<Vec3> line, const PointDistance& surface, double step_mm);

}  // namespace formwright
