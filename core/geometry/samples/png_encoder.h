// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "base/bytes.h"
#include "geometry/samples/sculpting/point.h"

namespace formwright::samples {

/// An 8-bit sRGB PNG from `pixels` x `pixels` linear colours, top row first.
Bytes encode_png(const std::vector<Point>& image, int pixels);

}  // namespace formwright::samples
