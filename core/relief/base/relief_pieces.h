// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A relief on a base in parts, cut where its rays pass from one part to the next: thesis Fig. 3.7, right.
#include <vector>

#include "base/context.h"
#include "relief/base/depth_bounds.h"
#include "relief/base/group_borders.h"

namespace formwright {

struct ReliefPieces {
  Positions V;                   // view coordinates, each vertex on its ray
  Triangles F;                   // turned as the relief's
  std::vector<int> band;         // of each triangle; no vertex belongs to triangles of two bands
  std::vector<int> origin;       // of each vertex, that of the relief which it is or lies nearest to
  Eigen::VectorXd above, below;  // of each vertex, DepthBounds::above_of and below_of where they are there
};

/// Cuts the joint surface exactly along the borders' planes, and brings each part back to its band by its own scale.
/// New vertices on a border keep to the bounds of their band. Parts in bands without a group are left out.
/// @param joint  n, u of the surface in one piece, as eq. (3.14) has it
/// @param m      of each group, mu = 1 + kappa m, or the shift in depth straight on
ReliefPieces cut_into_bands(const ViewFrame& frame, const Triangles& F, const Eigen::VectorXd& joint,
                            const Eigen::VectorXd& m, const DepthBounds& bounds, const GroupBorders& borders,
                            Context& context);

}  // namespace formwright
