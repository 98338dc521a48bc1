// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Three channels of floats and how far each pixel is to be trusted, for comparing pictures.
#include <cstddef>
#include <vector>

#include "base/context.h"
#include "base/lanes.h"
#include "imaging/picture/image.h"

namespace formwright {

/// width x height from the top left. Lanes 0 to 2: channels in grey levels (0 to 255); lane 3: the pixel's weight, 0
/// (nothing known there) to 1. A picture of one channel leaves the others 0.
struct WeightedPicture {
  int width = 0, height = 0;
  std::vector<Float4> pixels;

  WeightedPicture() = default;
  WeightedPicture(int w, int h)
      : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), Float4{}) {}
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
  Float4& at(int x, int y) { return pixels[index(x, y)]; }
  const Float4& at(int x, int y) const { return pixels[index(x, y)]; }
};

/// Bytes as they stand (sRGB, not linear light); alpha becomes the weight.
WeightedPicture weighted_picture(const Image& image);

/// Smaller, by means over the area of each new pixel, weighted; `width` and `height` at least a quarter of and at most
/// the picture's.
WeightedPicture reduced(const WeightedPicture& picture, int width, int height, const Context& context);

/// The weighted mean over a Gaussian of standard deviation `sigma_px` (0: the picture itself), cut at three of them;
/// the weights are averaged alike.
WeightedPicture smoothed(const WeightedPicture& picture, double sigma_px, const Context& context);

/// Between four pixels, at `x`, `y` in pixels from the middle of the first one; beyond the border as at the border.
Float4 bilinear(const WeightedPicture& picture, float x, float y);

/// Cubic convolution over 4 x 4 pixels (Keys 1981), which weakens fine detail far less than the mean of four; the
/// weight is the least of the four nearest pixels, and 0 beyond the border. Keeps to finite `x`, `y` of any size.
Float4 bicubic(const WeightedPicture& picture, float x, float y);

}  // namespace formwright
