// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Pairs of pictures with known displacement: a noise pattern, and the same seen through a smooth warp, blurred, lit and
// noisy as a camera does it.
#include <cmath>
#include <functional>
#include <random>

#include "geometry/mesh/triangle_mesh.h"
#include "imaging/drawing/noise_pattern.h"
#include "imaging/flow/variational_flow.h"

namespace formwright::test {

struct WarpedPair {
  WeightedPicture first, second;
  Flow truth;
};

struct Camera {
  double noise = 0;  // grey levels
  double blur_px = 0;
  double lighting = 0;  // share by which brightness changes across the picture
};

/// `back(y)`: where the place y of the second picture comes from, relative to y, in pixels from the middle. It must
/// change slowly enough to be inverted by repetition.
inline WarpedPair warped_pair(int width, int height, const std::function<Vec2(const Vec2&)>& back, const Camera& camera,
                              unsigned seed = 1) {
  const Context context;
  NoisePattern pattern;
  pattern.seed = seed;
  pattern.pixel_mm = 0.5;
  pattern.scales_mm = octaves_mm(5, 0.2 * std::min(width, height));
  constexpr int border = 40;  // pixels, so that warps do not leave it
  const WeightedPicture fine =
      weighted_picture(noise_picture(pattern, 2 * (width + 2 * border), 2 * (height + 2 * border), context));
  const WeightedPicture plain = reduced(fine, width + 2 * border, height + 2 * border, context);
  WarpedPair pair;
  pair.first = pair.second = WeightedPicture(width, height);
  pair.truth = {width, height, std::vector<float>(pair.first.pixels.size()),
                std::vector<float>(pair.first.pixels.size())};
  const Vec2 middle(0.5 * width, 0.5 * height);
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      pair.first.at(x, y) = plain.at(x + border, y + border);
      Float4 sum{};
      for (int k = 0; k < 4; ++k) {
        const Vec2 place(x + 0.25 + 0.5 * (k % 2), y + 0.25 + 0.5 * (k / 2));
        const Vec2 from = 2 * (place + back(place - middle) + Vec2::Constant(border));
        sum += 0.25f * bicubic(fine, static_cast<float>(from.x() - 0.5), static_cast<float>(from.y() - 0.5));
      }
      pair.second.at(x, y) = sum;
      const Vec2 here(x + 0.5, y + 0.5);
      Vec2 there = here;
      for (int k = 0; k < 60; ++k) there = here - back(there - middle);
      pair.truth.u[pair.truth.index(x, y)] = static_cast<float>(there.x() - here.x());
      pair.truth.v[pair.truth.index(x, y)] = static_cast<float>(there.y() - here.y());
    }
  pair.second = smoothed(pair.second, camera.blur_px, context);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float light = static_cast<float>(1 + camera.lighting * (static_cast<double>(x) / width - 0.5));
      Float4& p = pair.second.at(x, y);
      for (int c = 0; c < 3; ++c)
        p[c] = std::min(255.0f, std::max(0.0f, p[c] * light + static_cast<float>(camera.noise) * normal(random)));
    }
  return pair;
}

struct EndPointError {
  double mean = 0, root_mean_square = 0, percentile_95 = 0;
};

/// Over pixels at least `margin` from the border.
inline EndPointError end_point_error(const Flow& flow, const Flow& truth, int margin) {
  std::vector<double> errors;
  EndPointError result;
  for (int y = margin; y < flow.height - margin; ++y)
    for (int x = margin; x < flow.width - margin; ++x) {
      const std::size_t i = flow.index(x, y);
      const double e = std::hypot(flow.u[i] - truth.u[i], flow.v[i] - truth.v[i]);
      errors.push_back(e);
      result.mean += e;
      result.root_mean_square += e * e;
    }
  result.mean /= static_cast<double>(errors.size());
  result.root_mean_square = std::sqrt(result.root_mean_square / static_cast<double>(errors.size()));
  const auto at = errors.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(errors.size()));
  std::nth_element(errors.begin(), at, errors.end());
  result.percentile_95 = *at;
  return result;
}

/// Smooth in all directions, up to about `amplitude` pixels, with waves of `wave` pixels.
inline std::function<Vec2(const Vec2&)> waves(double amplitude, double wave) {
  return [=](const Vec2& p) {
    const double k = 2 * 3.14159265358979 / wave;
    return Vec2(amplitude * std::sin(k * (p.x() + 0.3 * p.y())) * std::cos(0.7 * k * p.y()),
                amplitude * std::cos(k * (0.8 * p.x() - 0.5 * p.y()) + 1));
  };
}

/// As a sheet over a dome: the middle grows, the slope shrinks.
inline std::function<Vec2(const Vec2&)> bulge(double amplitude, double radius) {
  return [=](const Vec2& p) {
    const double r_squared = p.squaredNorm() / (radius * radius);
    return Vec2(-amplitude * std::exp(-r_squared) * p / radius);
  };
}

}  // namespace formwright::test
