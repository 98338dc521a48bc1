// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Models put where a scene has them, and several made one.
#include <span>
#include <string>

#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// The model's box, as it comes, is scaled so that its longest side is `size_mm`; then it is turned about its middle,
/// about x first, then y, then z, counter-clockwise seen from the axis' end; the middle of the box that the turned
/// model has comes to lie at `at_mm`.
struct Placement {
  double size_mm = 100;
  Vec3 turn_deg{0, 0, 0};
  Vec3 at_mm{0, 0, 0};
};

/// n x 3, the vertices of a placed model. Throws Error{invalid_input, "mesh"}: no vertices, or all in one point.
Positions placed(const Positions& V, const Placement& placement);

/// One model of several, each a group of its own with its name of `names`; nothing is welded or cut. Vertex colours,
/// pictures and materials stay; models without colours are white where others have some.
Model joined(std::span<const Model> models, std::span<const std::string> names);

}  // namespace formwright
