// SPDX-License-Identifier: GPL-3.0-or-later
#include "imaging/colour/nearest_colour.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/parallel.h"

namespace formwright {
namespace {

constexpr std::int16_t none = 32767;

/// Per pixel, how many rows further down (negative: up) the nearest painted pixel of its column is; `none` beyond
/// reach.
std::vector<std::int16_t> along_columns(const Image& image, int reach, const Context& context) {
  std::vector<std::int16_t> offset(image.pixels.size(), none);
  parallel_for(static_cast<std::size_t>(image.width), 256, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    const int first = static_cast<int>(begin), last = static_cast<int>(end);
    for (int y = 0; y < image.height; ++y)
      for (int x = first; x < last; ++x) {
        const std::size_t i = image.index(x, y);
        if (image.pixels[i][3] != 0) offset[i] = 0;
        else if (y > 0 && offset[i - static_cast<std::size_t>(image.width)] != none &&
                 -offset[i - static_cast<std::size_t>(image.width)] < reach)
          offset[i] = static_cast<std::int16_t>(offset[i - static_cast<std::size_t>(image.width)] - 1);
      }
    for (int y = image.height - 2; y >= 0; --y)
      for (int x = first; x < last; ++x) {
        const std::size_t i = image.index(x, y), below = i + static_cast<std::size_t>(image.width);
        // The pixel below may look upwards through this one: only what lies below counts here.
        if (offset[below] == none || offset[below] < 0 || offset[below] >= reach) continue;
        const auto down = static_cast<std::int16_t>(offset[below] + 1);
        if (offset[i] == none || down < -offset[i]) offset[i] = down;
      }
  });
  return offset;
}

}  // namespace

void spread_colours(Image& image, double radius_px, const Context& context) {
  const int reach = static_cast<int>(std::floor(std::min(radius_px, 30000.0)));
  if (!(reach >= 1) || image.pixels.empty()) return;
  const std::vector<std::int16_t> offset = along_columns(image, reach, context);
  const double radius_squared = radius_px * radius_px;
  parallel_for(static_cast<std::size_t>(image.height), 32, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    // Lower envelope of the parabolas (x - centre)^2 + offset^2: centres, and where each begins to be the lowest.
    std::vector<int> centre(static_cast<std::size_t>(image.width)), from(centre);
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      const std::size_t row = image.index(0, y);
      const auto square = [&](int x) {
        const std::int64_t o = offset[row + static_cast<std::size_t>(x)];
        return o * o;
      };
      std::size_t count = 0;
      bool empty_ones = false;
      for (int x = 0; x < image.width; ++x) {
        const std::int16_t o = offset[row + static_cast<std::size_t>(x)];
        empty_ones = empty_ones || o != 0;
        if (o == none) continue;
        int start = 0;
        while (count > 0) {
          const int c = centre[count - 1];
          // First whole x at which the new one is strictly lower.
          const std::int64_t numerator =
              static_cast<std::int64_t>(x) * x - static_cast<std::int64_t>(c) * c + square(x) - square(c);
          const std::int64_t whole = 2 * static_cast<std::int64_t>(x - c);
          const std::int64_t crossing = numerator >= 0 ? numerator / whole + 1 : -((-numerator - 1) / whole);
          start = static_cast<int>(std::clamp<std::int64_t>(crossing, 0, image.width));
          if (start > from[count - 1]) break;
          --count;
          start = 0;
        }
        if (start >= image.width) continue;
        centre[count] = x;
        from[count++] = start;
      }
      if (count == 0 || !empty_ones) continue;
      for (std::size_t part = 0; part < count; ++part) {
        const int c = centre[part], last = part + 1 < count ? from[part + 1] : image.width;
        const Rgba colour = image.at(c, y + offset[row + static_cast<std::size_t>(c)]);
        for (int x = std::max(from[part], c - reach); x < std::min(last, c + reach + 1); ++x) {
          if (offset[row + static_cast<std::size_t>(x)] == 0) continue;
          const std::int64_t dx = x - c;
          if (static_cast<double>(dx * dx + square(c)) <= radius_squared) image.at(x, y) = colour;
        }
      }
    }
  });
}

}  // namespace formwright
