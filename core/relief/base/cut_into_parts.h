// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A relief on a base of several parts, cut where its rays pass from one part to the next.
#include "relief/base/base_parts.h"
#include "relief/base/relief_pieces.h"

namespace formwright {

/// As cut_into_bands, along the borders of what is seen of each part, which may run anywhere. `ReliefPieces::band` is
/// the part. What lies before no part is left out, and triangles
/// seen from their edge where a border crosses them.
ReliefPieces cut_into_parts(const ViewFrame& frame, const Triangles& F, const Eigen::VectorXd& joint,
                            const Eigen::VectorXd& m, const DepthBounds& bounds, const BaseParts& parts,
                            Context& context);

}  // namespace formwright
