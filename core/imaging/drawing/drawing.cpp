// SPDX-License-Identifier: GPL-3.0-or-later
#include "imaging/drawing/drawing.h"

#include <algorithm>
#include <cmath>

#include "imaging/picture/light.h"

namespace formwright {
namespace {

/// One undashed line, in pixels from the top left.
void draw_segment(Image& image, const Vec2& from, const Vec2& to, double width_px) {
  const double half = std::max(width_px, 1.0) / 2;
  const Vec2 lower = from.cwiseMin(to).array() - half - 1, upper = from.cwiseMax(to).array() + half + 1;
  const auto clamped = [](double value, int size) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(size)));
  };
  const auto& light = light_of_byte();
  const auto& byte = byte_of_light();
  const Vec2 along = to - from;
  const double squared = along.squaredNorm();
  for (int y = clamped(std::floor(lower.y()), image.height); y < clamped(std::ceil(upper.y()), image.height); ++y)
    for (int x = clamped(std::floor(lower.x()), image.width); x < clamped(std::ceil(upper.x()), image.width); ++x) {
      const Vec2 p(x + 0.5, y + 0.5);
      const double t = squared > 0 ? std::clamp((p - from).dot(along) / squared, 0.0, 1.0) : 0.0;
      const double paper =
          std::clamp((p - from - t * along).norm() - half + 0.5, 0.0, 1.0);  // share of the pixel left as it is
      if (paper >= 1) continue;
      Rgba& pixel = image.at(x, y);
      for (std::size_t k = 0; k < 3; ++k) pixel[k] = byte[static_cast<std::size_t>(paper * light[pixel[k]])];
      pixel[3] = 255;
    }
}

}  // namespace

void Drawing::rectangle(const Vec2& lower, const Vec2& upper, double width_mm, bool dashed) {
  const Vec2 corners[4] = {lower, {upper.x(), lower.y()}, upper, {lower.x(), upper.y()}};
  for (int k = 0; k < 4; ++k) line(corners[k], corners[(k + 1) % 4], width_mm, dashed);
}

void Drawing::cross(const Vec2& centre, double arm_mm, double width_mm) {
  line(centre - Vec2(arm_mm, 0), centre + Vec2(arm_mm, 0), width_mm);
  line(centre - Vec2(0, arm_mm), centre + Vec2(0, arm_mm), width_mm);
}

void draw(Image& image, const Drawing& drawing, double pixel_mm) {
  const auto pixel = [&](const Vec2& p) {
    return Vec2(image.width / 2.0 + p.x() / pixel_mm, image.height / 2.0 - p.y() / pixel_mm);
  };
  const auto stroke = [&](const Stroke& s) {
    const double length = (s.to - s.from).norm();
    const int dashes = s.dashed ? static_cast<int>(std::clamp(std::ceil(length / (2 * dash_mm)), 1.0, 10000.0)) : 1;
    for (int i = 0; i < dashes; ++i) {
      const double begin = s.dashed && length > 0 ? 2 * i * dash_mm / length : 0,
                   end = s.dashed && length > 0 ? std::min(1.0, begin + dash_mm / length) : 1;
      draw_segment(image, pixel(s.from + begin * (s.to - s.from)), pixel(s.from + end * (s.to - s.from)),
                   s.width_mm / pixel_mm);
    }
  };
  for (const Stroke& s : drawing.strokes) stroke(s);
  for (const Label& label : drawing.labels)
    for (const Stroke& s : outlined(label).strokes) stroke(s);
}

}  // namespace formwright
