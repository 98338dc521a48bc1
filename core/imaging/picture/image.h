// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A picture as files and printers know it.
#include <array>
#include <cstdint>
#include <vector>

#include "base/context.h"

namespace formwright {

using Rgba = std::array<std::uint8_t, 4>;  // sRGB, alpha not multiplied in

/// width x height pixels from the top left, row by row.
struct Image {
  int width = 0, height = 0;
  std::vector<Rgba> pixels;

  Image() = default;
  Image(int w, int h, Rgba fill)
      : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), fill) {}
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
  Rgba& at(int x, int y) { return pixels[index(x, y)]; }
  const Rgba& at(int x, int y) const { return pixels[index(x, y)]; }
};

/// A tiled or printed page can be this large; 32-bit WASM has 4 GB for everything.
inline constexpr std::int64_t max_image_pixels = sizeof(void*) == 4 ? 40'000'000 : 200'000'000;

/// Left and right exchanged.
void mirror_left_right(Image& image);

/// The picture with each square of `side` x `side` pixels as one, averaged in linear light; opaque (alpha counts as
/// white behind). Squares at the right and lower edge may be cut off.
Image shrunk(const Image& image, int side, const Context& context);

}  // namespace formwright
