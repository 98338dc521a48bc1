// SPDX-License-Identifier: GPL-3.0-or-later
#include "imaging/picture/weighted_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "imaging/picture/overlap_shares.h"

namespace formwright {
namespace {

/// Colours times their weight, the weight itself in lane 3.
Float4 weighed(const Float4& p) { return Float4{p[0] * p[3], p[1] * p[3], p[2] * p[3], p[3]}; }
Float4 unweighed(const Float4& p) {
  if (!(p[3] > 1e-6f)) return Float4{};
  const float scale = 1 / p[3];
  return Float4{p[0] * scale, p[1] * scale, p[2] * scale, std::min(p[3], 1.0f)};
}

constexpr std::size_t rows_a_chunk = 32;

}  // namespace

WeightedPicture weighted_picture(const Image& image) {
  WeightedPicture picture(image.width, image.height);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const Rgba& p = image.pixels[i];
    picture.pixels[i] = Float4{static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]),
                               static_cast<float>(p[3]) / 255.0f};
  }
  return picture;
}

WeightedPicture reduced(const WeightedPicture& picture, int width, int height, const Context& context) {
  if (width < 1 || height < 1 || width > picture.width || height > picture.height || 4 * width < picture.width ||
      4 * height < picture.height)
    throw Error(ErrorCode::internal, "", "A picture can be reduced to a quarter at once, not further.");
  if (width == picture.width && height == picture.height) return picture;
  const auto columns = overlap_shares<6>(picture.width, width), rows = overlap_shares<6>(picture.height, height);
  WeightedPicture result(width, height);
  parallel_for(static_cast<std::size_t>(height), rows_a_chunk, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    std::vector<Float4> line(static_cast<std::size_t>(picture.width));
    for (std::size_t y = begin; y < end; ++y) {
      std::fill(line.begin(), line.end(), Float4{});
      for (int k = 0; k < rows[y].count; ++k) {
        const Float4* from = &picture.at(0, rows[y].first + k);
        const float weight = rows[y].weight[static_cast<std::size_t>(k)];
        for (std::size_t x = 0; x < line.size(); ++x) line[x] += weight * weighed(from[x]);
      }
      for (std::size_t x = 0; x < columns.size(); ++x) {
        Float4 sum{};
        for (int k = 0; k < columns[x].count; ++k)
          sum += columns[x].weight[static_cast<std::size_t>(k)] * line[static_cast<std::size_t>(columns[x].first + k)];
        result.at(static_cast<int>(x), static_cast<int>(y)) = unweighed(sum);
      }
    }
  });
  return result;
}

WeightedPicture smoothed(const WeightedPicture& picture, double sigma_px, const Context& context) {
  if (!(sigma_px > 0)) return picture;
  const int radius = std::max(1, static_cast<int>(std::ceil(3 * sigma_px)));
  std::vector<float> kernel(static_cast<std::size_t>(radius) + 1);
  double sum = 0;
  for (int k = 0; k <= radius; ++k) sum += (k == 0 ? 1 : 2) * std::exp(-0.5 * k * k / (sigma_px * sigma_px));
  for (int k = 0; k <= radius; ++k)
    kernel[static_cast<std::size_t>(k)] = static_cast<float>(std::exp(-0.5 * k * k / (sigma_px * sigma_px)) / sum);
  WeightedPicture across(picture.width, picture.height), result(picture.width, picture.height);
  const int w = picture.width, h = picture.height;
  parallel_for(static_cast<std::size_t>(h), rows_a_chunk, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
      for (int x = 0; x < w; ++x) {
        Float4 total = kernel[0] * weighed(picture.at(x, y));
        for (int k = 1; k <= radius; ++k)
          total += kernel[static_cast<std::size_t>(k)] *
                   (weighed(picture.at(std::max(x - k, 0), y)) + weighed(picture.at(std::min(x + k, w - 1), y)));
        across.at(x, y) = total;
      }
  });
  parallel_for(static_cast<std::size_t>(h), rows_a_chunk, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
      for (int x = 0; x < w; ++x) {
        Float4 total = kernel[0] * across.at(x, y);
        for (int k = 1; k <= radius; ++k)
          total += kernel[static_cast<std::size_t>(k)] *
                   (across.at(x, std::max(y - k, 0)) + across.at(x, std::min(y + k, h - 1)));
        result.at(x, y) = unweighed(total);
      }
  });
  return result;
}

Float4 bilinear(const WeightedPicture& picture, float x, float y) {
  x = std::clamp(x, 0.0f, static_cast<float>(picture.width - 1));
  y = std::clamp(y, 0.0f, static_cast<float>(picture.height - 1));
  const int x0 = std::min(static_cast<int>(x), std::max(0, picture.width - 2)),
            y0 = std::min(static_cast<int>(y), std::max(0, picture.height - 2));
  const int x1 = std::min(x0 + 1, picture.width - 1), y1 = std::min(y0 + 1, picture.height - 1);
  const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
  const Float4 upper = picture.at(x0, y0) + fx * (picture.at(x1, y0) - picture.at(x0, y0));
  const Float4 lower = picture.at(x0, y1) + fx * (picture.at(x1, y1) - picture.at(x0, y1));
  return upper + fy * (lower - upper);
}

Float4 bicubic(const WeightedPicture& picture, float x, float y) {
  const int w = picture.width, h = picture.height;
  if (!(x >= 0 && y >= 0 && x <= static_cast<float>(w - 1) && y <= static_cast<float>(h - 1))) {
    Float4 border = bilinear(picture, x, y);
    border[3] = 0;
    return border;
  }
  const int x0 = std::min(static_cast<int>(x), w - 2 < 0 ? 0 : w - 2),
            y0 = std::min(static_cast<int>(y), h - 2 < 0 ? 0 : h - 2);
  if (x0 < 1 || y0 < 1 || x0 + 2 >= w || y0 + 2 >= h) return bilinear(picture, x, y);
  const float s = x - static_cast<float>(x0), t = y - static_cast<float>(y0);
  const auto weights = [](float f) {
    return std::array<float, 4>{f * (-0.5f + f * (1 - 0.5f * f)), 1 + f * f * (-2.5f + 1.5f * f),
                                f * (0.5f + f * (2 - 1.5f * f)), f * f * (-0.5f + 0.5f * f)};
  };
  const std::array<float, 4> a = weights(s), b = weights(t);
  Float4 sum{};
  for (int k = 0; k < 4; ++k) {
    const Float4* row = &picture.at(x0 - 1, y0 - 1 + k);
    sum += b[static_cast<std::size_t>(k)] * (a[0] * row[0] + a[1] * row[1] + a[2] * row[2] + a[3] * row[3]);
  }
  const Float4 *upper = &picture.at(x0, y0), *lower = &picture.at(x0, y0 + 1);
  sum[3] = std::min(std::min(upper[0][3], upper[1][3]), std::min(lower[0][3], lower[1][3]));
  return sum;
}

}  // namespace formwright
