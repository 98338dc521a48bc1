// SPDX-License-Identifier: GPL-3.0-or-later
#include "imaging/picture/light_picture.h"

#include <algorithm>
#include <cmath>

#include "imaging/picture/light.h"

namespace formwright {

double LightPicture::bilinear(const Vec2& place_px) const {
  const double x = std::clamp(place_px.x() - 0.5, 0.0, width - 1.0),
               y = std::clamp(place_px.y() - 0.5, 0.0, height - 1.0);
  const int x0 = std::min(static_cast<int>(x), std::max(0, width - 2)),
            y0 = std::min(static_cast<int>(y), std::max(0, height - 2));
  const int x1 = std::min(x0 + 1, width - 1), y1 = std::min(y0 + 1, height - 1);
  const double u = x - x0, v = y - y0;
  return (1 - v) * ((1 - u) * at(x0, y0) + u * at(x1, y0)) + v * ((1 - u) * at(x0, y1) + u * at(x1, y1));
}

LightPicture light_picture(const Image& image, const Context& context) {
  constexpr double red = 0.2126, green = 0.7152, blue = 0.0722;
  LightPicture picture{image.width, image.height, std::vector<std::uint16_t>(image.pixels.size())};
  const auto& light = light_of_byte();
  for (int y = 0; y < image.height; ++y) {
    if (y % 256 == 0) context.check_cancelled();
    for (int x = 0; x < image.width; ++x) {
      const Rgba& p = image.at(x, y);
      picture.light[image.index(x, y)] =
          static_cast<std::uint16_t>(red * light[p[0]] + green * light[p[1]] + blue * light[p[2]] + 0.5);
    }
  }
  return picture;
}

}  // namespace formwright
