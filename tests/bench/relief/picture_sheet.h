// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Sheets of pictures from the viewpoint: surfaces under one light, and the angles between their normals in colour.
#include <string>

#include "imaging/picture/image.h"
#include "relief/seen/normal_picture.h"

namespace formwright::test {

struct SheetPlace {
  int left = 0, top = 0;
};

/// Brightness under one light from the upper left, dark in front of nothing.
void shade_into(Image& sheet, const NormalPicture& picture, SheetPlace place);

/// The angle between the normals of two pictures of one grid: dark blue for 0, yellow from `max_angle_deg` on.
void colour_angles_into(Image& sheet, const NormalPicture& model, const NormalPicture& relief, double max_angle_deg,
                        SheetPlace place);

/// The colours of colour_angles_into with their angles, in the middle of a place of `width` x `height` pixels.
void colour_scale_into(Image& sheet, double max_angle_deg, SheetPlace place, int width, int height);

/// As FOLDER/NAME.png; makes the folder.
void write_sheet(const Image& sheet, const std::string& folder, const std::string& name, const Context& context);

}  // namespace formwright::test
