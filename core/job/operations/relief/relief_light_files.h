// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The files of a lit relief: pictures, its front with the light on it, a lithophane.
#include "job/operations/relief/relief_light_scene.h"
#include "relief/light/lithophane.h"

namespace formwright {

/// `light` times `exposure` as sRGB greys, 1 being white; clear where nothing is covered. Rows from the bottom, as
/// pixels of a view are.
Bytes light_picture(const PictureView& view, const std::vector<char>& covered, const std::vector<double>& light,
                    double exposure, Context& context);

/// The relief through another view of the same plate, as light_picture.
Bytes picture_of_relief(const KeptLight& kept, const PictureView& view, const std::vector<double>& light,
                        double exposure, Context& context);

/// Pictures from left to right, 5 degrees apart up to 60 on either side, as a zip: "01_left_60_deg.png" and so on.
Bytes walk_past(const KeptLight& kept, const std::vector<double>& light, double exposure, Context& context);

/// The solid's front in the axes of relief.ply, with the column "brightness", 0 to 1, linear.
Bytes lit_front(const KeptLight& kept, double width_mm, const std::vector<double>& light, double exposure,
                Context& context);

/// 16 bits, white is the thickest. Where the model is not seen, the plate is of middle brightness.
Bytes lithophane_picture(const PictureView& view, const SeenModel& model, const std::vector<double>& light,
                         double exposure, const Lithophane& plate, Context& context);

}  // namespace formwright
