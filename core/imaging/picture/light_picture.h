// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A photograph as linear light, in which blur keeps an edge in its place.
#include <cstdint>
#include <vector>

#include "geometry/mesh/triangle_mesh.h"
#include "imaging/picture/image.h"

namespace formwright {

/// width x height from the top left, 0 to 65535: the mean of red, green and blue with the weights of ITU-R BT.709.
struct LightPicture {
  int width = 0, height = 0;
  std::vector<std::uint16_t> light;

  double at(int x, int y) const {
    return light[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  }
  /// Between four pixels, at a place in pixels from the picture's top left corner: the middle of the first pixel is at
  /// 0.5, 0.5. Beyond the border as at the border; the place must be finite.
  double bilinear(const Vec2& place_px) const;
};

LightPicture light_picture(const Image& image, const Context& context);

}  // namespace formwright
