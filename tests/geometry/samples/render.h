// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Pictures of meshes for the documentation: a z-buffer, one lamp with a shadow, ambient occlusion. No window, no GPU.
#include "geometry/samples/png_pixels.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright::test {

struct RenderOptions {
  int width = 400, height = 400;
  Vec3 view_direction{0, 0, -1};  // from the viewer into the scene; seen straight on, without perspective
  Vec3 view_up{0, 1, 0};
  Vec3 lamp{-0.55, 0.75, 0.65};   // where the light comes from: right, up, towards the viewer
  double millimetres_across = 0;  // of the picture's width; 0: the model fills nine tenths
  bool floor = true;              // a shadow on the plane that the model stands on (least y)
  bool use_colours = true;        // vertex colours or texture; otherwise plaster
  double crease_deg = 40;         // faces that meet under more are shaded apart
  Vec3 background{0.87, 0.87, 0.88};
};

RgbPicture render(const Model& model, const RenderOptions& options);

/// Puts `tile` onto `sheet` with its top left corner at (x, y).
void paste(RgbPicture& sheet, const RgbPicture& tile, int x, int y);

RgbPicture blank_picture(int width, int height, const Vec3& linear_colour);

}  // namespace formwright::test
