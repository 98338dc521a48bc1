// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Four triangles of every one. Loop 1987, "Smooth Subdivision Surfaces Based on Triangles", with the
// boundary rules of Hoppe et al. 1994.
#include "base/context.h"
#include "base/data/parameters.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

enum class SubdivisionScheme {
  midpoint,  // the same surface
  loop,      // a smooth one
};
template <>
struct EnumNames<SubdivisionScheme> {
  static constexpr std::array<std::string_view, 2> names{"midpoint", "loop"};
  static constexpr std::array<std::string_view, 2> labels{"Midpoint", "Loop"};
};

/// Old vertices come first, in order; face f becomes faces 4 f ... 4 f + 3, the last one in its middle.
/// Needs faces oriented alike and at most two at an edge. Throws Error: invalid_input ("mesh", "levels"
/// when the result would have more than 2^28 triangles), cancelled.
TriangleMesh subdivide(const TriangleMesh& mesh, SubdivisionScheme scheme, int levels, Context& context);

/// Texture coordinates and colours are interpolated, groups and materials inherited.
Model subdivide(const Model& model, SubdivisionScheme scheme, int levels, Context& context);

/// Where Loop subdivision takes each vertex in the end, n x 3.
Positions loop_limit(const TriangleMesh& mesh);

}  // namespace formwright
