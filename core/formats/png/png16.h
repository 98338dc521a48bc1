// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// 16-bit grey PNG with a physical size: height maps.
#include <cstdint>
#include <string_view>
#include <vector>

#include "base/bytes.h"
#include "base/context.h"

namespace formwright {

struct Grey16Image {
  int width = 0, height = 0;
  double pixel_width_mm = 0, pixel_height_mm = 0;  // 0: not stated
  std::vector<std::uint16_t> levels;               // height * width, from the top left, row by row
};

/// The pixel's size goes into pHYs, as whole pixels per metre: 0.1 mm is exact, 0.3 mm is off by 0.01 %.
/// Throws Error{internal} for an image whose levels are not width * height; Error{cancelled}.
Bytes write_png16(const Grey16Image& image, const Context& context = Context());

/// Any PNG, turned to grey (ITU-R BT.709 weights) and 16 bits; transparency is dropped.
/// Throws Error{invalid_input, where}: not a PNG, damaged, over `max_pixels`.
Grey16Image read_png16(ByteView bytes, std::string_view file_name, std::string_view where = "image",
                       std::size_t max_pixels = 256'000'000);

}  // namespace formwright
