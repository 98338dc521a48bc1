// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// 8-bit PNG with a physical size.
#include <Eigen/Core>

#include "base/bytes.h"
#include "imaging/picture/image.h"

namespace formwright {

/// Whole pixels per metre, which is what a PNG can say: 300 dpi are 11811.02 and so 11811, 0.2 parts in 100,000 off.
int pixels_per_metre(double dots_per_inch);

/// RGB where every pixel is opaque, RGBA otherwise; sRGB; pHYs where `per_metre` is not 0.
/// Throws Error{internal} for an image whose pixels are not width * height; Error{cancelled}.
Bytes write_png(const Image& image, int per_metre, const Context& context);
/// With another number of pixels per metre along x than along y.
Bytes write_png(const Image& image, const Eigen::Vector2i& per_metre, const Context& context);

}  // namespace formwright
