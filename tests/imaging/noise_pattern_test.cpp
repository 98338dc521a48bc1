// SPDX-License-Identifier: GPL-3.0-or-later
#include "imaging/drawing/noise_pattern.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/LU>
#include <cmath>

#include "base/sha256.h"
#include "imaging/colour/colour_correction.h"
#include "imaging/picture/weighted_picture.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

NoisePattern pattern(std::uint32_t seed = 7) { return {seed, 0.25, octaves_mm(1, 16), 0.2}; }

TEST_CASE("NoisePattern.ScalesDoubleUpToTheCoarsest") {
  CHECK(octaves_mm(1, 16) == std::vector<double>{1, 2, 4, 8, 16});
  CHECK(octaves_mm(1.5, 5) == std::vector<double>{1.5, 3});
}

TEST_CASE("NoisePattern.HasTheDeviationAskedForAndChannelsOfTheirOwn") {
  const Image image = noise_picture(pattern(), 1200, 1000, Context());
  double mean[3] = {}, squared[3] = {}, cross[3] = {};
  const double n = static_cast<double>(image.pixels.size());
  for (const Rgba& p : image.pixels)
    for (std::size_t c = 0; c < 3; ++c) {
      const double a = p[c] - 127.5, b = p[(c + 1) % 3] - 127.5;
      mean[c] += a / n;
      squared[c] += a * a / n;
      cross[c] += a * b / n;
    }
  for (int c = 0; c < 3; ++c) {
    CHECK_THAT(mean[c], WithinAbs(0, 8));
    CHECK_THAT(std::sqrt(squared[c]), WithinAbs(0.2 * 255, 6));
    CHECK_THAT(cross[c] / squared[c], WithinAbs(0, 0.2));  // few cells of the coarsest scale
  }
}

TEST_CASE("NoisePattern.IsTheSameOnEveryMachineAndUnlikeForOtherSeeds") {
  const auto hash = [](const Image& image) {
    return sha256_hex(ByteView(reinterpret_cast<const std::byte*>(image.pixels.data()), 4 * image.pixels.size()));
  };
  const std::string first = hash(noise_picture(pattern(), 200, 150, Context()));
  CHECK(first == "002253a80c67b7798b6760dc4799bf6e58e6f21123bb20ec0ff4ea7b3c5c2b68");
  CHECK(first != hash(noise_picture(pattern(8), 200, 150, Context())));
}

TEST_CASE("NoisePattern.IsTheSameNoiseAtAnyResolutionAndSize") {
  NoisePattern fine = pattern();
  fine.pixel_mm /= 2;
  const WeightedPicture coarse = weighted_picture(noise_picture(pattern(), 200, 160, Context()));
  const WeightedPicture reduced_fine =
      reduced(weighted_picture(noise_picture(fine, 400, 320, Context())), 200, 160, Context());
  const Image larger = noise_picture(pattern(), 240, 180, Context());
  double squared = 0;
  for (int y = 0; y < 160; ++y)
    for (int x = 0; x < 200; ++x) {
      const Float4 d = coarse.at(x, y) - reduced_fine.at(x, y);
      squared += static_cast<double>(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) / 3 / (200 * 160);
      CHECK(static_cast<float>(larger.at(x + 20, y + 10)[0]) == coarse.at(x, y)[0]);
    }
  CHECK(std::sqrt(squared) < 1.5);
}

std::vector<ColourSample> seen_colours(const ColourCorrection& camera_inverse, int outliers) {
  std::vector<ColourSample> samples;
  for (int i = 0; i < 120; ++i) {
    const Vec3 expected(0.1 + 0.8 * ((i * 37) % 100) / 100.0, 0.1 + 0.8 * ((i * 59) % 100) / 100.0,
                        0.1 + 0.8 * ((i * 83) % 100) / 100.0);
    const Vec2 place(-1 + 2 * ((i * 29) % 120) / 119.0, -1 + 2 * ((i * 71) % 120) / 119.0);
    const Vec3 seen =
        camera_inverse.matrix.inverse() * (expected - camera_inverse.offset) * camera_inverse.light(place);
    samples.push_back({place, i < outliers ? Vec3(0.2, 0.2, 0.2) : seen, expected});
  }
  return samples;
}

TEST_CASE("ColourCorrection.CastAndLightAreFoundExactlyDespiteForeignPatches") {
  ColourCorrection truth;
  truth.matrix << 1.3, -0.1, 0.02, -0.05, 1.1, -0.08, 0.0, -0.2, 1.6;
  truth.offset = {-0.01, -0.02, 0.01};
  truth.log_light = {0.3, -0.2, -0.15, 0.05, -0.1};
  for (const int outliers : {0, 20}) {
    const std::vector<ColourSample> samples = seen_colours(truth, outliers);
    const ColourCorrection found = fit_colour_correction(samples);
    double worst = 0;
    for (std::size_t i = static_cast<std::size_t>(outliers); i < samples.size(); ++i)
      worst = std::max(worst, (found(samples[i].seen, samples[i].place) - samples[i].expected).cwiseAbs().maxCoeff());
    {
      INFO(outliers);
      CHECK(worst < 1e-4);
    }
    CHECK(found.rejected >= outliers * 9 / 10);
  }
}

}  // namespace
}  // namespace formwright
