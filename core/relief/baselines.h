// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a maker would get without the optimisation, in the same slab: to show beside, and to be honest.
#include "base/context.h"
#include "relief/base/depth_bounds.h"
#include "relief/view/view_frame.h"
#include "relief/view/visibility.h"

namespace formwright {

/// Depth compressed linearly along the rays so that the bounded vertices just fill their bounds: the nearest of them
/// comes to its nearest depth, the farthest to its farthest. The others follow the same line. Lengths are normalised.
Eigen::VectorXd linear_compression(const ViewFrame& frame, const DepthBounds& bounds);

struct GradientCompressionOptions {
  double steepest_slope = 8;  // depth per length in the picture; steeper faces are silhouettes and count as flat
  double compression = 5;     // a in C(g) = log(1 + a g) / a
};

/// Gradient-domain compression in the manner of Weyrich et al. 2007 on the triangles instead of pixels, as in
/// thesis Fig. 3.11, without sharpening: depth gradients on the picture plane, silhouette steps removed, their
/// lengths compressed by C(g) = log(1 + a g) / a, depth restored by a Poisson solve over the visible faces, scaled to
/// the slab. Hidden vertices keep linear compression. Throws Error: could_not_solve, cancelled.
Eigen::VectorXd gradient_domain_compression(const ViewFrame& frame, const Triangles& F, const Visibility& visibility,
                                            double thickness, const GradientCompressionOptions& options,
                                            Context& context);

}  // namespace formwright
