// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>

#include "base/index.h"
#include "base/parallel.h"
#include "relief/seen/picture_similarity.h"

namespace formwright {
namespace {

constexpr int blur_radius = 9;
constexpr int blur_taps = 2 * blur_radius + 1;
// exp(-k^2 / (2 * 3^2)), k = 0 to 9, over their sum from -9 to 9; as numbers, so that every machine has the same.
constexpr std::array<float, blur_radius + 1> half_window{0.13317600f, 0.12597909f, 0.10663900f, 0.08077532f,
                                                         0.05475029f, 0.03320773f, 0.01802341f, 0.00875346f,
                                                         0.00380424f, 0.00147945f};
constexpr int search_radius = 6;
// A crease of angle t between two planes is a step 2 sin(t / 2) of the normal. Smoothed by a Gaussian of sigma = 3 its
// steepest slope is that step over sigma sqrt(2 pi).
constexpr float pixels_per_step = 7.5198848f;      // 3 sqrt(2 pi)
constexpr float edge_step = 0.5176381f;            // 2 sin(30 degrees / 2)
constexpr float suspected_edge_step = 0.2610524f;  // 2 sin(15 degrees / 2)
constexpr std::size_t picture_rows_per_chunk = 32;

using Plane = std::vector<float>;

/// The mean under a Gaussian window, row by row and then column by column; zeros beyond the picture.
Plane blurred(const Plane& source, int w, int h) {
  Plane across(source.size()), result(source.size());
  const auto tap = [](int k) { return half_window[index(k < 0 ? -k : k)]; };
  parallel_for(index(h), picture_rows_per_chunk, [&](std::size_t begin, std::size_t end) {
    std::vector<float> row(index(w) + 2 * blur_radius, 0);
    for (std::size_t y = begin; y < end; ++y) {
      std::copy_n(&source[y * index(w)], w, &row[blur_radius]);
      float* out = &across[y * index(w)];
      std::fill(out, out + w, 0.0f);
      for (int k = 0; k < blur_taps; ++k)
        for (int x = 0; x < w; ++x) out[x] += tap(k - blur_radius) * row[index(x + k)];
    }
  });
  parallel_for(index(h), picture_rows_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) {
      float* out = &result[y * index(w)];
      std::fill(out, out + w, 0.0f);
      for (int k = -blur_radius; k <= blur_radius; ++k) {
        const int from = static_cast<int>(y) + k;
        if (from < 0 || from >= h) continue;
        const float* in = &across[index(from) * index(w)];
        for (int x = 0; x < w; ++x) out[x] += tap(k) * in[x];
      }
    }
  });
  return result;
}

/// By how much the smoothed normals turn at each pixel, as the step of the crease that would turn them as fast.
Plane turning(const NormalPicture& picture, const Plane& mask, const Plane& weight) {
  const int w = picture.grid.columns, h = picture.grid.rows;
  Plane squares(mask.size(), 0);
  for (const std::vector<float>* component : {&picture.x, &picture.y, &picture.z}) {
    Plane masked(mask.size());
    for (std::size_t p = 0; p < mask.size(); ++p) masked[p] = mask[p] * (*component)[p];
    Plane smooth = blurred(masked, w, h);
    for (std::size_t p = 0; p < mask.size(); ++p) smooth[p] = mask[p] > 0 ? smooth[p] / weight[p] : 0.0f;
    const auto slope = [&](std::size_t here, bool has_before, std::size_t before, bool has_after, std::size_t after) {
      const std::size_t a = has_before && mask[before] > 0 ? before : here,
                        b = has_after && mask[after] > 0 ? after : here;
      if (a == b) return 0.0f;
      return (smooth[b] - smooth[a]) / (a != here && b != here ? 2.0f : 1.0f);
    };
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const std::size_t p = picture.at(y, x);
        if (mask[p] == 0) continue;
        const float dx = slope(p, x > 0, p - 1, x + 1 < w, p + 1);
        const float dy = slope(p, y > 0, p - index(w), y + 1 < h, p + index(w));
        squares[p] += dx * dx + dy * dy;
      }
  }
  for (float& one : squares) one = pixels_per_step * std::sqrt(one);
  return squares;
}

/// The largest value within `search_radius` rows and columns.
Plane largest_around(const Plane& source, int w, int h) {
  Plane across(source.size()), result(source.size());
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const auto first = source.begin() + static_cast<std::ptrdiff_t>(index(y) * index(w));
      across[index(y) * index(w) + index(x)] =
          *std::max_element(first + std::max(0, x - search_radius), first + std::min(w, x + search_radius + 1));
    }
  for (int y = 0; y < h; ++y)
    for (int k = std::max(0, y - search_radius); k <= std::min(h - 1, y + search_radius); ++k)
      for (int x = 0; x < w; ++x) {
        float& out = result[index(y) * index(w) + index(x)];
        out = std::max(out, across[index(k) * index(w) + index(x)]);
      }
  return result;
}

}  // namespace

double false_edges_percent(const NormalPicture& model, const NormalPicture& relief, Context& context) {
  const int w = model.grid.columns, h = model.grid.rows;
  Plane mask(model.covered.size());
  std::size_t pixels = 0;
  for (std::size_t p = 0; p < mask.size(); ++p) {
    mask[p] = model.covered[p] && relief.covered[p] ? 1.0f : 0.0f;
    pixels += mask[p] > 0;
  }
  if (pixels == 0) return 0;
  const Plane weight = blurred(mask, w, h);
  context.check_cancelled();
  const Plane of_model = largest_around(turning(model, mask, weight), w, h);
  context.check_cancelled();
  const Plane of_relief = turning(relief, mask, weight);
  std::size_t false_edges = 0;
  for (std::size_t p = 0; p < mask.size(); ++p)
    false_edges += mask[p] > 0 && of_relief[p] >= edge_step && of_model[p] < suspected_edge_step;
  return 100.0 * static_cast<double>(false_edges) / static_cast<double>(pixels);
}

}  // namespace formwright
