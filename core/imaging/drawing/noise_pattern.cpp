// SPDX-License-Identifier: GPL-3.0-or-later
#include "imaging/drawing/noise_pattern.h"

#include <array>
#include <cmath>

#include "base/parallel.h"

namespace formwright {
namespace {

/// Avalanching 32-bit hash (lowbias32: Wellons 2018).
std::uint32_t hashed(std::uint32_t v) {
  v ^= v >> 16;
  v *= 0x7feb352dU;
  v ^= v >> 15;
  v *= 0x846ca68bU;
  v ^= v >> 16;
  return v;
}

/// A number of mean 0 and variance 1 for a node of a lattice: the sum of twelve bytes, near enough to Gaussian.
float normal_of(std::uint32_t stream, std::int64_t column, std::int64_t row) {
  std::uint32_t state = hashed(stream ^ hashed(static_cast<std::uint32_t>(column) * 0x9e3779b1U ^
                                               hashed(static_cast<std::uint32_t>(row) + 0x85ebca6bU)));
  std::uint32_t sum = 0;
  for (int k = 0; k < 3; ++k) {
    sum += (state & 255) + (state >> 8 & 255) + (state >> 16 & 255) + (state >> 24);
    state = hashed(state + 0x9e3779b9U);
  }
  // Twelve uniform bytes: mean 1530, variance 12 (256^2 - 1) / 12.
  return (static_cast<float>(sum) - 1530.0f) / 255.99804f;
}

/// Cubic B-spline over four nodes, which smooths as a Gaussian of 0.58 spacings does.
std::array<float, 4> spline(float t) {
  const float s = 1 - t;
  return {s * s * s / 6, (4 - 6 * t * t + 3 * t * t * t) / 6, (4 - 6 * s * s + 3 * s * s * s) / 6, t * t * t / 6};
}

/// Standard deviation of that sum over all places: the square of the mean over t of the sum of the squared weights, one
/// factor an axis.
constexpr float spline_deviation = 151.0f / 315.0f;

struct Tap {
  std::int64_t node;
  std::array<float, 4> weight;
};
std::vector<Tap> taps(int count, double pixel_mm, double scale_mm) {
  std::vector<Tap> all(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const double place = (i + 0.5 - count / 2.0) * pixel_mm / scale_mm, node = std::floor(place);
    all[static_cast<std::size_t>(i)] = {static_cast<std::int64_t>(node) - 1, spline(static_cast<float>(place - node))};
  }
  return all;
}

}  // namespace

std::vector<double> octaves_mm(double finest_mm, double coarsest_mm) {
  std::vector<double> scales;
  for (double scale = finest_mm; scale <= coarsest_mm * (1 + 1e-9); scale *= 2) scales.push_back(scale);
  return scales;
}

Image noise_picture(const NoisePattern& pattern, int width, int height, const Context& context) {
  Image image(width, height, {128, 128, 128, 255});
  std::vector<std::vector<Tap>> across, down;
  for (const double scale : pattern.scales_mm) {
    across.push_back(taps(width, pattern.pixel_mm, scale));
    down.push_back(taps(height, pattern.pixel_mm, scale));
  }
  const float gain =
      static_cast<float>(255 * pattern.contrast / std::sqrt(static_cast<double>(pattern.scales_mm.size()))) /
      spline_deviation;
  parallel_for(static_cast<std::size_t>(height), 64, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    std::vector<float> sum(3 * static_cast<std::size_t>(width)), nodes;
    for (std::size_t y = begin; y < end; ++y) {
      std::fill(sum.begin(), sum.end(), 0.0f);
      for (std::size_t s = 0; s < across.size(); ++s) {
        const std::vector<Tap>& columns = across[s];
        const Tap& row = down[s][y];
        const std::int64_t first = columns.front().node;
        const auto count = static_cast<std::size_t>(columns.back().node - first) + 4;
        nodes.resize(count);
        for (std::size_t channel = 0; channel < 3; ++channel) {
          const std::uint32_t stream =
              hashed(pattern.seed * 0x2545f491U + static_cast<std::uint32_t>(97 * s + 7 * channel + 1));
          for (std::size_t n = 0; n < count; ++n) {
            float value = 0;
            for (std::size_t k = 0; k < 4; ++k)
              value += row.weight[k] *
                       normal_of(stream, first + static_cast<std::int64_t>(n), row.node + static_cast<std::int64_t>(k));
            nodes[n] = value;
          }
          for (std::size_t x = 0; x < columns.size(); ++x) {
            const float* node = nodes.data() + (columns[x].node - first);
            const std::array<float, 4>& weight = columns[x].weight;
            sum[3 * x + channel] +=
                weight[0] * node[0] + weight[1] * node[1] + weight[2] * node[2] + weight[3] * node[3];
          }
        }
      }
      for (std::size_t x = 0; x < static_cast<std::size_t>(width); ++x)
        for (std::size_t channel = 0; channel < 3; ++channel) {
          const float value = 127.5f + gain * sum[3 * x + channel];
          image.at(static_cast<int>(x), static_cast<int>(y))[channel] =
              static_cast<std::uint8_t>((value < 10    ? 10
                                         : value > 245 ? 245
                                                       : value) +
                                        0.5f);
        }
    }
  });
  return image;
}

}  // namespace formwright
