// SPDX-License-Identifier: GPL-3.0-or-later
#include "imaging/picture/linear_picture.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "imaging/picture/light.h"
#include "imaging/picture/overlap_shares.h"

namespace formwright {
namespace {

constexpr int max_probes = 16;

}  // namespace

LinearPicture::LinearPicture(const Image& image, bool repeat, const Context& context) : repeat_(repeat) {
  if (image.width < 1 || image.height < 1) throw Error(ErrorCode::internal, "", "A texture has no pixels.");
  Level& first = levels_.emplace_back();
  first.width = image.width;
  first.height = image.height;
  first.texels.resize(image.pixels.size());
  const auto& light = light_of_byte();
  parallel_for(image.pixels.size(), 1 << 16, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t k = 0; k < 3; ++k)  // the fourth stays 0
        first.texels[i][k] = static_cast<std::uint16_t>((light[image.pixels[i][k]] * std::uint32_t{image.pixels[i][3]} +
                                                         65535u * (255u - image.pixels[i][3]) + 127u) /
                                                        255u);
  });
  while (levels_.back().width > 1 || levels_.back().height > 1) levels_.push_back(halved(levels_.back(), context));
}

LinearPicture::Level LinearPicture::halved(const Level& fine, const Context& context) {
  Level coarse;
  coarse.width = std::max(1, fine.width / 2);
  coarse.height = std::max(1, fine.height / 2);
  coarse.texels.resize(static_cast<std::size_t>(coarse.width) * static_cast<std::size_t>(coarse.height));
  const auto columns = overlap_shares<3>(fine.width, coarse.width),
             rows = overlap_shares<3>(fine.height, coarse.height);
  parallel_for(rows.size(), 64, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (std::size_t y = begin; y < end; ++y)
      for (std::size_t x = 0; x < columns.size(); ++x) {
        Light sum{};
        for (int j = 0; j < rows[y].count; ++j)
          for (int i = 0; i < columns[x].count; ++i) {
            const float weight =
                rows[y].weight[static_cast<std::size_t>(j)] * columns[x].weight[static_cast<std::size_t>(i)];
            const auto& texel =
                fine.texels[static_cast<std::size_t>(rows[y].first + j) * static_cast<std::size_t>(fine.width) +
                            static_cast<std::size_t>(columns[x].first + i)];
            sum += weight * __builtin_convertvector(texel, Float4);
          }
        coarse.texels[y * columns.size() + x] = __builtin_convertvector(lesser(sum + 0.5f, Float4{} + 65535.0f), Texel);
      }
  });
  return coarse;
}

LinearPicture::Footprint LinearPicture::footprint(const Eigen::Matrix2d& texels_per_dot) const {
  // The ellipse that a round dot covers: singular values and the longer axis of the 2 x 2 matrix, in closed form.
  const Eigen::Matrix2d gram = texels_per_dot * texels_per_dot.transpose();
  const double mean = 0.5 * gram.trace(), difference = 0.5 * (gram(0, 0) - gram(1, 1));
  const double spread = std::hypot(difference, gram(0, 1));
  const double longer = std::sqrt(mean + spread), shorter = std::sqrt(std::max(0.0, mean - spread));
  Footprint result;
  if (!std::isfinite(longer)) {
    result.level = static_cast<int>(levels_.size()) - 1;
    return result;
  }
  if (longer <= 1) return result;  // enlarged: plain interpolation
  result.probes = static_cast<int>(
      std::clamp(std::ceil(longer / std::max(shorter, 1.0) - 1e-9), 1.0, static_cast<double>(max_probes)));
  const double diameter = std::max({longer / result.probes, shorter, 1.0});
  const double level = std::min(std::log2(diameter), static_cast<double>(levels_.size()) - 1);
  result.level = static_cast<int>(level);
  result.blend = static_cast<float>(level - result.level);
  Vec2 axis(difference + spread, gram(0, 1));  // of the larger eigenvalue, unless it vanishes
  if (difference < 0) axis = Vec2(gram(0, 1), spread - difference);
  if (axis.norm() > 0) axis *= longer / result.probes / axis.norm();
  result.step = Vec2(axis.x() / width(), axis.y() / height());
  return result;
}

Light LinearPicture::bilinear(const Level& level, const Vec2& place) const {
  const double x = place.x() * level.width - 0.5, y = place.y() * level.height - 0.5;
  const double left = std::floor(x), top = std::floor(y);
  const auto wrapped = [&](double i, int size) {
    if (!repeat_) return static_cast<std::size_t>(std::clamp(i, 0.0, size - 1.0));
    const double turns = std::floor(i / size);
    return static_cast<std::size_t>(std::clamp(i - turns * size, 0.0, size - 1.0));
  };
  const std::size_t x0 = wrapped(left, level.width), x1 = wrapped(left + 1, level.width);
  const std::size_t row0 = wrapped(top, level.height) * static_cast<std::size_t>(level.width),
                    row1 = wrapped(top + 1, level.height) * static_cast<std::size_t>(level.width);
  const auto fx = static_cast<float>(x - left), fy = static_cast<float>(y - top);
  const auto texel = [&](std::size_t i) { return __builtin_convertvector(level.texels[i], Float4); };
  const Float4 upper = texel(row0 + x0) * (1 - fx) + texel(row0 + x1) * fx;
  const Float4 lower = texel(row1 + x0) * (1 - fx) + texel(row1 + x1) * fx;
  return upper * (1 - fy) + lower * fy;
}

Light LinearPicture::sample(const Vec2& place, const Footprint& footprint) const {
  Light sum{};
  const auto level = static_cast<std::size_t>(footprint.level);
  for (int i = 0; i < footprint.probes; ++i) {
    const Vec2 at = place + (i - 0.5 * (footprint.probes - 1)) * footprint.step;
    Light light = bilinear(levels_[level], at);
    if (footprint.blend > 0 && level + 1 < levels_.size()) {
      light += footprint.blend * (bilinear(levels_[level + 1], at) - light);
    }
    sum += light;
  }
  return sum / static_cast<float>(footprint.probes);
}

}  // namespace formwright
