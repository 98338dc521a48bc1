// SPDX-License-Identifier: GPL-3.0-or-later
#include "imaging/picture/image.h"

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "imaging/picture/light.h"

namespace formwright {

void mirror_left_right(Image& image) {
  const auto width = static_cast<std::ptrdiff_t>(image.width);
  for (std::ptrdiff_t y = 0; y < image.height; ++y)
    std::reverse(image.pixels.begin() + y * width, image.pixels.begin() + (y + 1) * width);
}

Image shrunk(const Image& image, int side, const Context& context) {
  if (image.width < 1 || image.height < 1 || side < 1)
    throw Error(ErrorCode::internal, "", "A picture without pixels cannot be shrunk.");
  Image small((image.width + side - 1) / side, (image.height + side - 1) / side, {255, 255, 255, 255});
  const auto& light = light_of_byte();
  const auto& byte = byte_of_light();
  parallel_for(static_cast<std::size_t>(small.height), 32, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
      for (int x = 0; x < small.width; ++x) {
        std::array<std::uint64_t, 3> sum{};
        std::uint64_t count = 0;
        for (int v = y * side; v < std::min(image.height, (y + 1) * side); ++v)
          for (int u = x * side; u < std::min(image.width, (x + 1) * side); ++u, ++count) {
            const Rgba& p = image.at(u, v);
            for (std::size_t k = 0; k < 3; ++k)
              sum[k] += (static_cast<std::uint64_t>(light[p[k]]) * p[3] + 65535u * (255u - p[3])) / 255;
          }
        for (std::size_t k = 0; k < 3; ++k) small.at(x, y)[k] = byte[static_cast<std::size_t>(sum[k] / count)];
      }
  });
  return small;
}

}  // namespace formwright
