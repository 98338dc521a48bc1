// SPDX-License-Identifier: GPL-3.0-or-later
#include "imaging/picture/weighted_picture.h"

#include <algorithm>
#include <array>

namespace formwright {
WeightedPicture weighted_picture(const Image& image) {
  WeightedPicture picture(image.width, image.height);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const Rgba& p = image.pixels[i];
    picture.pixels[i] = Float4{static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]),
                               static_cast<float>(p[3]) / 255.0f};
  }
  return picture;
}

Float4 bilinear(const WeightedPicture& picture, float x, float y) {
  x = std::clamp(x, 0.0f, static_cast<float>(picture.width - 1));
  y = std::clamp(y, 0.0f, static_cast<float>(picture.height - 1));
  const int x0 = std::min(static_cast<int>(x), std::max(0, picture.width - 2)),
            y0 = std::min(static_cast<int>(y), std::max(0, picture.height - 2));
  const int x1 = std::min(x0 + 1, picture.width - 1), y1 = std::min(y0 + 1, picture.height - 1);
  const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
  const Float4 upper = picture.at(x0, y0) + fx * (picture.at(x1, y0) - picture.at(x0, y0));
  const Float4 lower = picture.at(x0, y1) + fx * (picture.at(x1, y1) - picture.at(x0, y1));
  return upper + fy * (lower - upper);
}

Float4 bicubic(const WeightedPicture& picture, float x, float y) {
  const int w = picture.width, h = picture.height;
  if (!(x >= 0 && y >= 0 && x <= static_cast<float>(w - 1) && y <= static_cast<float>(h - 1))) {
    Float4 border = bilinear(picture, x, y);
    border[3] = 0;
    return border;
  }
  const int x0 = std::min(static_cast<int>(x), w - 2 < 0 ? 0 : w - 2),
            y0 = std::min(static_cast<int>(y), h - 2 < 0 ? 0 : h - 2);
  if (x0 < 1 || y0 < 1 || x0 + 2 >= w || y0 + 2 >= h) return bilinear(picture, x, y);
  const float s = x - static_cast<float>(x0), t = y - static_cast<float>(y0);
  const auto weights = [](float f) {
    return std::array<float, 4>{f * (-0.5f + f * (1 - 0.5f * f)), 1 + f * f * (-2.5f + 1.5f * f),
                                f * (0.5f + f * (2 - 1.5f * f)), f * f * (-0.5f + 0.5f * f)};
  };
  const std::array<float, 4> a = weights(s), b = weights(t);
  Float4 sum{};
  for (int k = 0; k < 4; ++k) {
    const Float4* row = &picture.at(x0 - 1, y0 - 1 + k);
    sum += b[static_cast<std::size_t>(k)] * (a[0] * row[0] + a[1] * row[1] + a[2] * row[2] + a[3] * row[3]);
  }
  const Float4 *upper = &picture.at(x0, y0), *lower = &picture.at(x0, y0 + 1);
  sum[3] = std::min(std::min(upper[0][3], upper[1][3]), std::min(lower[0][3], lower[1][3]));
  return sum;
}

}  // namespace formwright
