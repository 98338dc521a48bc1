// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch_test_macros.hpp>

#include <random>

#include "imaging/colour/nearest_colour.h"

namespace formwright {
namespace {

/// Few painted pixels of all different colours.
Image scattered(int width, int height, int painted, unsigned seed) {
  Image image(width, height, {255, 255, 255, 0});
  std::mt19937 random(seed);
  for (int i = 0; i < painted; ++i) {
    const int x = static_cast<int>(random() % static_cast<unsigned>(width)),
              y = static_cast<int>(random() % static_cast<unsigned>(height));
    image.at(x, y) = {static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y), 7, 255};  // says where it was
  }
  return image;
}

TEST_CASE("NearestColour.AgreesWithTryingAllPixels") {
  for (const auto& [painted, radius] : {std::pair{5, 100.0}, {40, 9.0}, {40, 3.5}, {400, 1.0}, {3, 1.5}, {0, 5.0}}) {
    const Image before = scattered(97, 61, painted, static_cast<unsigned>(painted));
    Image after = before;
    spread_colours(after, radius, Context());
    for (int y = 0; y < before.height; ++y)
      for (int x = 0; x < before.width; ++x) {
        int minimum = 1 << 30;
        for (int v = 0; v < before.height; ++v)
          for (int u = 0; u < before.width; ++u)
            if (before.at(u, v)[3] != 0) minimum = std::min(minimum, (u - x) * (u - x) + (v - y) * (v - y));
        const Rgba& p = after.at(x, y);
        if (minimum > radius * radius) {
          INFO(x << " " << y << " radius " << radius);
          REQUIRE(p == before.at(x, y));
        } else {
          REQUIRE(p[3] == 255);
          INFO(x << " " << y << " radius " << radius);
          REQUIRE((p[0] - x) * (p[0] - x) + (p[1] - y) * (p[1] - y) == minimum);
        }
      }
  }
}

TEST_CASE("NearestColour.PaintedPixelsStay") {
  const Image before = scattered(200, 100, 300, 1);
  Image after = before;
  spread_colours(after, 20, Context());
  for (std::size_t i = 0; i < before.pixels.size(); ++i)
    if (before.pixels[i][3] != 0) {
      CHECK(after.pixels[i] == before.pixels[i]);
    }
}

}  // namespace
}  // namespace formwright
