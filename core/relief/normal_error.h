// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The true normal error, eqs. (3.2) and (3.5) as an angle, before any linearisation.
#include "relief/view/view_frame.h"
#include "relief/view/visibility.h"

namespace formwright {

struct NormalError {
  Eigen::VectorXd vertex_deg;  // n: angle between area-weighted vertex normals
  double mean_deg = 0;         // visible faces, weighted by their area on the model
  double mean_deg_image = 0;   // visible faces, weighted by the area they cover in the picture
};

/// `moved`: n x 3 positions in view coordinates. Means are 0 when no face is visible.
NormalError normal_error(const ViewFrame& frame, const Triangles& F, const Visibility& visibility,
                         const Positions& moved);

}  // namespace formwright
