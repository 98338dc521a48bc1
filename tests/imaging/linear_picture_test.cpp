// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>
#include <random>

#include "imaging/picture/light.h"
#include "imaging/picture/linear_picture.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

Image noise(int width, int height) {
  Image image(width, height, {0, 0, 0, 255});
  std::mt19937 random(5);
  for (Rgba& p : image.pixels)
    for (std::size_t k = 0; k < 3; ++k) p[k] = static_cast<std::uint8_t>(random());
  return image;
}

double mean_light(const Image& image, std::size_t channel) {
  double sum = 0;
  for (const Rgba& p : image.pixels) sum += light_of_byte()[p[channel]];
  return sum / static_cast<double>(image.pixels.size());
}

TEST_CASE("LinearPicture.TexelsAreExactWhereNothingIsFiltered") {
  const Image image = noise(13, 7);
  const LinearPicture picture(image, false, Context());
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Light light = picture.sample(Vec2((x + 0.5) / image.width, (y + 0.5) / image.height),
                                         picture.footprint(Eigen::Matrix2d::Identity() * 0.5));
      for (std::size_t k = 0; k < 3; ++k)
        CHECK_THAT(static_cast<double>(light[k]), WithinAbs(light_of_byte()[image.at(x, y)[k]], 0.1));
    }
}

TEST_CASE("LinearPicture.AFootprintOverAllOfItGivesItsMeanLight") {
  for (const auto& [width, height] : {std::pair{64, 64}, {100, 37}, {1, 9}}) {
    const Image image = noise(width, height);
    const LinearPicture picture(image, true, Context());
    const double size = 4.0 * std::max(width, height);
    const Light light = picture.sample(Vec2(0.4, 0.6), picture.footprint(Eigen::Matrix2d::Identity() * size));
    for (std::size_t k = 0; k < 3; ++k)
      CHECK_THAT(static_cast<double>(light[k]), WithinAbs(mean_light(image, k), 12));  // rounding of some levels
  }
}

TEST_CASE("LinearPicture.BlackAndWhiteAverageInLight") {
  Image image(64, 64, {255, 255, 255, 255});
  for (int y = 0; y < 64; ++y)
    for (int x = y % 2; x < 64; x += 2) image.at(x, y) = {0, 0, 0, 255};
  const LinearPicture picture(image, true, Context());
  const Light light = picture.sample(Vec2(0.5, 0.5), picture.footprint(Eigen::Matrix2d::Identity() * 8));
  CHECK(byte_of_light()[static_cast<std::size_t>(light[0])] == 188);  // not 128
  CHECK(shrunk(image, 8, Context()).at(3, 3) == Rgba{188, 188, 188, 255});
}

TEST_CASE("LinearPicture.LongFootprintsBlurAlongOneDirectionOnly") {
  // Stripes that change along v stay sharp under a footprint that is long along u, and vanish under one along v.
  Image image(128, 128, {255, 255, 255, 255});
  for (int y = 0; y < 128; ++y)
    for (int x = 0; x < 128; ++x)
      if (y / 8 % 2 == 0) image.at(x, y) = {0, 0, 0, 255};
  const LinearPicture picture(image, true, Context());
  const auto contrast = [&](double along_u, double along_v) {
    const auto footprint = picture.footprint(Eigen::Vector2d(along_u, along_v).asDiagonal());
    const float dark = picture.sample(Vec2(0.5, 68.0 / 128), footprint)[0],
                bright = picture.sample(Vec2(0.5, 60.0 / 128), footprint)[0];
    return std::abs(bright - dark) / 65535;
  };
  CHECK(contrast(12, 1) > 0.99f);
  CHECK(contrast(1, 16) < 0.1f);
}

TEST_CASE("LinearPicture.BordersGoOnOrRepeat") {
  Image image(2, 1, {255, 0, 0, 255});
  image.at(1, 0) = {0, 0, 255, 255};
  const LinearPicture clamped(image, false, Context()), tiled(image, true, Context());
  const auto red = [](const LinearPicture& p, double u) {
    return p.sample(Vec2(u, 0.5), p.footprint(Eigen::Matrix2d::Identity()))[0];
  };
  CHECK(red(clamped, 1.25) == 0);
  CHECK(red(tiled, 1.25) == 65535);
  CHECK(red(clamped, 0.01) == 65535);
  CHECK_THAT(red(tiled, 0.0), WithinAbs(65535 / 2.0, 1));
  CHECK(red(tiled, -3.75) == 65535);
}

TEST_CASE("LinearPicture.TransparentPartsAreWhitePaper") {
  Image image(1, 1, {0, 0, 0, 0});
  CHECK(LinearPicture(image, true, Context()).sample(Vec2(0, 0), {})[1] == 65535);
  image.at(0, 0)[3] = 51;  // a fifth of black
  CHECK_THAT(LinearPicture(image, true, Context()).sample(Vec2(0, 0), {})[1], WithinAbs(0.8 * 65535, 1));
}

TEST_CASE("Light.BytesComeBack") {
  for (std::size_t i = 0; i < 256; ++i) CHECK(byte_of_light()[light_of_byte()[i]] == i);
}

}  // namespace
}  // namespace formwright
