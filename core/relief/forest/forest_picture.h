// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The finished forest as somebody sees it.
#include <span>

#include "imaging/picture/image.h"
#include "relief/forest/forest.h"

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

}  // namespace formwright
