// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>
#include <cmath>
#include <random>

#include "imaging/picture/weighted_picture.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

/// Noise of which a third of the pixels is not known.
WeightedPicture spotted_noise(int width, int height) {
  WeightedPicture picture(width, height);
  std::mt19937 random(11);
  for (Float4& p : picture.pixels) {
    for (std::size_t k = 0; k < 3; ++k) p[k] = static_cast<float>(random() % 256);
    p[3] = random() % 3 == 0 ? 0.0f : 1.0f;
  }
  return picture;
}

TEST_CASE("ScaledPicture.APixelIsTheWeightedMeanOverItsArea") {
  const WeightedPicture picture = spotted_noise(50, 70), result = reduced(picture, 20, 35, Context());
  for (int y = 0; y < 35; ++y)
    for (int x = 0; x < 20; ++x) {
      double sum = 0, weight = 0, area = 0;
      for (int v = 0; v < 70; ++v)
        for (int u = 0; u < 50; ++u) {
          const double across = std::min(u + 1.0, 2.5 * (x + 1)) - std::max<double>(u, 2.5 * x);
          const double down = std::min(v + 1.0, 2.0 * (y + 1)) - std::max<double>(v, 2.0 * y);
          if (across <= 0 || down <= 0) continue;
          area += across * down;
          weight += across * down * static_cast<double>(picture.at(u, v)[3]);
          sum += across * down * static_cast<double>(picture.at(u, v)[3] * picture.at(u, v)[0]);
        }
      CHECK_THAT(static_cast<double>(result.at(x, y)[3]), WithinAbs(weight / area, 1e-5));
      if (weight > 0) CHECK_THAT(static_cast<double>(result.at(x, y)[0]), WithinAbs(sum / weight, 1e-3));
    }
}

TEST_CASE("ScaledPicture.ABlurIsTheWeightedMeanOverAGaussianInEveryRow") {
  // Higher than a band of rows that one thread blurs.
  constexpr int width = 9, height = 600, radius = 5;
  constexpr double sigma_px = 1.6;
  const WeightedPicture picture = spotted_noise(width, height), result = smoothed(picture, sigma_px, Context());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      double sum = 0, weight = 0, all = 0;
      for (int v = -radius; v <= radius; ++v)
        for (int u = -radius; u <= radius; ++u) {
          const Float4& p = picture.at(std::clamp(x + u, 0, width - 1), std::clamp(y + v, 0, height - 1));
          const double share = std::exp(-0.5 * (u * u + v * v) / (sigma_px * sigma_px));
          all += share;
          weight += share * static_cast<double>(p[3]);
          sum += share * static_cast<double>(p[3] * p[0]);
        }
      CHECK_THAT(static_cast<double>(result.at(x, y)[3]), WithinAbs(weight / all, 1e-5));
      CHECK_THAT(static_cast<double>(result.at(x, y)[0]), WithinAbs(sum / weight, 1e-3));
    }
}

}  // namespace
}  // namespace formwright
