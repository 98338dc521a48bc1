// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The finished forest as somebody sees it, and a model before a relief is made of it.
#include <span>

#include "imaging/picture/image.h"
#include "relief/forest/forest.h"
#include "relief/view/view_frame.h"

namespace formwright {

/// Where a picture is taken from: the eye, what is in its middle, and the width that it shows there.
struct ForestCamera {
  Vec3 eye_mm{0, 0, 0}, look_at_mm{0, 0, 0};
  double width_mm = 0;
};

/// What a viewpoint sees, a little more than its model. `height_share`: height of the model as a share of its width.
ForestCamera camera_of(const ForestViewpoint& viewpoint, double height_share);
/// From between the first two viewpoints that are not beside each other, higher up and far enough to see all pillars;
/// with one viewpoint, from its side.
ForestCamera camera_from_elsewhere(const ForestScene& scene);

/// Matt pillars on a white floor in light from the upper left of the camera, without shadows; four rays a pixel. The
/// picture is `pixels` wide and four fifths as high. Throws Error: cancelled.
Image picture_of_forest(const StandingForest& forest, const RayCaster& caster, const ForestCamera& camera, int pixels,
                        Context& context);

/// The model of a viewpoint as its eye sees it, in the same light; transparent where nothing of it is seen. Its seen
/// width is `pixels` wide, and the picture as high as the model, its middle the middle of what is looked at.
/// `F`: triangles of the model that `frame` was made for. Throws Error: cancelled.
Image picture_of_model(const ViewFrame& frame, const Triangles& F, int pixels, Context& context);

}  // namespace formwright
