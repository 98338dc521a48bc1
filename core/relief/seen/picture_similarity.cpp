// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/seen/picture_similarity.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/index.h"
#include "base/parallel.h"

namespace formwright {
namespace {

constexpr int window_radius = 5;
constexpr int window_taps = 2 * window_radius + 1;
// exp(-k^2 / (2 * 1.5^2)), k = -5 to 5, over their sum; as numbers, so that every machine has the same.
constexpr std::array<float, window_taps> window{0.00102838008447911f, 0.00759875813523919f, 0.03600077212843083f,
                                                0.10936068950970002f, 0.21300553771125370f, 0.26601172486179436f,
                                                0.21300553771125370f, 0.10936068950970002f, 0.03600077212843083f,
                                                0.00759875813523919f, 0.00102838008447911f};
constexpr float luminance_constant = 0.01f * 0.01f, contrast_constant = 0.03f * 0.03f;

// Fields whose means under the window the similarity needs: brightness, squares and product.
constexpr int field_count = 5;

struct ColumnSpan {
  int begin = 0, end = 0;  // columns
};

/// The pixels that both pictures cover, with the window's weight on them.
struct Mask {
  std::vector<float> both, weight;
  std::vector<ColumnSpan> span;  // of each row
};

Mask mask_of(const NormalPicture& a, const NormalPicture& b) {
  const int w = a.grid.columns, h = a.grid.rows;
  Mask mask;
  mask.both.resize(a.covered.size());
  for (std::size_t p = 0; p < mask.both.size(); ++p) mask.both[p] = a.covered[p] && b.covered[p] ? 1.0f : 0.0f;
  mask.span.resize(index(h));
  mask.weight.assign(a.covered.size(), 0);
  std::vector<float> across(a.covered.size(), 0);
  for (int y = 0; y < h; ++y) {
    ColumnSpan& span = mask.span[index(y)];
    span = {w, 0};
    for (int x = 0; x < w; ++x) {
      if (mask.both[a.at(y, x)] == 0) continue;
      span.begin = std::min(span.begin, x);
      span.end = x + 1;
    }
    for (int x = 0; x < w; ++x)
      for (int k = std::max(-window_radius, -x); k <= std::min(window_radius, w - 1 - x); ++k)
        across[a.at(y, x)] += window[index(k + window_radius)] * mask.both[a.at(y, x + k)];
  }
  for (int y = 0; y < h; ++y)
    for (int k = std::max(-window_radius, -y); k <= std::min(window_radius, h - 1 - y); ++k)
      for (int x = 0; x < w; ++x) mask.weight[a.at(y, x)] += window[index(k + window_radius)] * across[a.at(y + k, x)];
  return mask;
}

/// Brightness of one row under a light, with `window_radius` zeros on either side.
void shade(const NormalPicture& picture, const Mask& mask, int y, const std::array<float, 3>& light, float* row) {
  const std::size_t first = picture.at(y, 0);
  const float *x = &picture.x[first], *ny = &picture.y[first], *z = &picture.z[first], *m = &mask.both[first];
  for (int i = 0; i < picture.grid.columns; ++i) {
    const float s = light[0] * x[i] + light[1] * ny[i] + light[2] * z[i];
    row[window_radius + i] = s > 0 ? s * m[i] : 0.0f;
  }
}

/// Sum of the similarity over the mask under one light.
double similarity_sum(const NormalPicture& a, const NormalPicture& b, const Mask& mask, const Vec3& direction,
                      const Context& context) {
  const int w = a.grid.columns, h = a.grid.rows, padded = w + 2 * window_radius;
  const std::array<float, 3> light{static_cast<float>(direction.x()), static_cast<float>(direction.y()),
                                   static_cast<float>(direction.z())};
  std::vector<float> rows_a(index(padded) * window_taps, 0), rows_b(rows_a), down(index(padded) * field_count);
  const auto row_of = [&](std::vector<float>& rows, int y) {
    return &rows[index((y + window_taps) % window_taps) * index(padded)];
  };
  const auto fill = [&](int y) {
    float *ra = row_of(rows_a, y), *rb = row_of(rows_b, y);
    if (y < h) {
      shade(a, mask, y, light, ra);
      shade(b, mask, y, light, rb);
    } else {
      std::fill(ra, ra + padded, 0.0f);
      std::fill(rb, rb + padded, 0.0f);
    }
  };
  for (int y = 0; y < window_radius; ++y) fill(y);
  double sum = 0;
  for (int y = 0; y < h; ++y) {
    fill(y + window_radius);
    const ColumnSpan span = mask.span[index(y)];
    if (span.begin >= span.end) continue;
    if (y % 64 == 0) context.check_cancelled();
    // Down the columns first: the sums over eleven rows.
    const int from = span.begin, to = span.end + 2 * window_radius;
    float *ma = &down[0], *mb = ma + padded, *aa = mb + padded, *bb = aa + padded, *ab = bb + padded;
    for (int f = 0; f < field_count; ++f)
      std::fill(&down[index(f * padded + from)], &down[index(f * padded)] + to, 0.0f);
    for (int k = -window_radius; k <= window_radius; ++k) {
      const float *ra = row_of(rows_a, y + k), *rb = row_of(rows_b, y + k), g = window[index(k + window_radius)];
      for (int x = from; x < to; ++x) {
        const float va = ra[x], vb = rb[x], ga = g * va, gb = g * vb;
        ma[x] += ga;
        mb[x] += gb;
        aa[x] += ga * va;
        bb[x] += gb * vb;
        ab[x] += ga * vb;
      }
    }
    const float *weight = &mask.weight[a.at(y, 0)], *both = &mask.both[a.at(y, 0)];
    constexpr int block = 64;
    for (int x0 = span.begin; x0 < span.end; x0 += block) {
      const int many = std::min(block, span.end - x0);
      float s[field_count][block] = {};
      for (int f = 0; f < field_count; ++f)
        for (int k = 0; k < window_taps; ++k) {
          const float g = window[index(k)], *source = &down[index(f * padded + x0 + k)];
          for (int x = 0; x < many; ++x) s[f][x] += g * source[x];
        }
      for (int x = 0; x < many; ++x) {
        if (both[x0 + x] == 0) continue;
        const float share = 1 / weight[x0 + x];
        const float mean_a = s[0][x] * share, mean_b = s[1][x] * share;
        const float var_a = s[2][x] * share - mean_a * mean_a, var_b = s[3][x] * share - mean_b * mean_b,
                    cov = s[4][x] * share - mean_a * mean_b;
        const float product = mean_a * mean_b;
        sum += static_cast<double>(
            (product + product + luminance_constant) * (cov + cov + contrast_constant) /
            ((mean_a * mean_a + mean_b * mean_b + luminance_constant) * (var_a + var_b + contrast_constant)));
      }
    }
  }
  return sum;
}

}  // namespace

std::vector<Vec3> light_directions(int count) {
  // The golden angle turns from one light to the next; as numbers, so that every machine has the same lights.
  constexpr double cosine = -0.7373688780783197, sine = 0.6754902942615238;
  std::vector<Vec3> lights;
  double x = 1, y = 0;
  for (int k = 0; k < count; ++k) {
    const double z = (k + 0.5) / count, across = std::sqrt(1 - z * z);
    lights.emplace_back(across * x, across * y, z);
    const double turned = cosine * x - sine * y;
    y = sine * x + cosine * y;
    x = turned;
  }
  return lights;
}

double picture_similarity(const NormalPicture& model, const NormalPicture& relief, std::span<const Vec3> lights,
                          Context& context) {
  const Mask mask = mask_of(model, relief);
  double pixels = 0;
  for (const float one : mask.both) pixels += static_cast<double>(one);
  if (pixels == 0 || lights.empty()) return 1;
  std::vector<double> sums(lights.size());
  parallel_for(lights.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) sums[k] = similarity_sum(model, relief, mask, lights[k], context);
  });
  double sum = 0;
  for (const double one : sums) sum += one;
  return sum / (pixels * static_cast<double>(lights.size()));
}

double brightness_similarity(int columns, int rows, const std::vector<float>& model, const std::vector<float>& relief,
                             const std::vector<char>& mask, Context& context) {
  // A light along x shows the first component of a normal as it is.
  const auto picture_of = [&](const std::vector<float>& brightness) {
    NormalPicture picture;
    picture.grid = {columns, rows, 0, 0};
    picture.x = brightness;
    picture.y.assign(brightness.size(), 0);
    picture.z.assign(brightness.size(), 0);
    picture.covered = mask;
    return picture;
  };
  const std::array<Vec3, 1> along_x{Vec3(1, 0, 0)};
  return picture_similarity(picture_of(model), picture_of(relief), along_x, context);
}

}  // namespace formwright
