// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Colour pictures for tests: any PNG into bytes by libpng, and a small palette PNG out.
#include <cstdint>
#include <vector>

#include "base/bytes.h"

namespace formwright::test {

struct RgbPicture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> bytes;  // sRGB, 3 a pixel, from the top left, row by row; empty when it could not be read

  const std::uint8_t* pixel(int x, int y) const {
    return &bytes[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x))];
  }
};

/// `behind`: grey level behind clear parts.
RgbPicture decode_png(ByteView png, std::uint8_t behind = 0);

/// With the 255 colours that fit best: about a third of the size in full colour.
Bytes encode_palette_png(const RgbPicture& picture);

}  // namespace formwright::test
