// SPDX-License-Identifier: GPL-3.0-or-later
// The number in the back of a tile, and the mark that points up.
#include <algorithm>
#include <cmath>
#include <string>

#include "imaging/drawing/drawing.h"
#include "relief/forest/plan/pillar.h"
#include "relief/tiles/tile_solid.h"

namespace formwright {
namespace {

constexpr double max_height_mm = 8, min_height_mm = 2.2;
constexpr double height_share = 0.35;                // of the back's smaller side
constexpr double stroke_share = 0.16;                // of the number's height
constexpr double depth_mm = 0.6, depth_share = 0.4;  // at most, and of what the plate has

/// The number and above it an arrow that points up, about 0, for a height of the number.
std::vector<Stroke> strokes_of(int number, double height_mm) {
  std::vector<Stroke> strokes = outlined({Vec2(0, -0.4 * height_mm), height_mm, std::to_string(number)}).strokes;
  const Vec2 tip(0, 1.0 * height_mm);
  for (const double side : {-1.0, 1.0}) strokes.push_back({tip, tip + 0.4 * height_mm * Vec2(side, -1)});
  return strokes;
}

Outline around(const Stroke& stroke, double width_mm, const Vec2& middle) {
  // Mirrored, because the back is seen from behind.
  const auto placed = [&](const Vec2& p) { return Vec2(middle.x() - p.x(), middle.y() + p.y()); };
  const Vec2 from = placed(stroke.from), to = placed(stroke.to), along = (to - from).normalized(),
             half(-0.5 * width_mm * along.y(), 0.5 * width_mm * along.x());
  const Vec2 begin = from - 0.5 * width_mm * along, end = to + 0.5 * width_mm * along;
  return {begin - half, end - half, end + half, begin + half};
}

}  // namespace

std::vector<TriangleMesh> number_grooves(const std::vector<Vec2>& outline, int number, double plate_mm) {
  Vec2 low = outline.front(), high = low, middle(0, 0);
  for (const Vec2& p : outline) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
    middle += p / static_cast<double>(outline.size());
  }
  const double depth = std::min(depth_mm, depth_share * plate_mm);
  for (double height = std::min(max_height_mm, height_share * (high - low).minCoeff()); height >= min_height_mm;
       height *= 0.8) {
    const double width = stroke_share * height;
    std::vector<TriangleMesh> grooves;
    bool fits = true;
    for (const Stroke& stroke : strokes_of(number, height)) {
      const Outline groove = around(stroke, width, middle);
      for (const Vec2& p : groove) fits = fits && is_inside(outline, p) && distance_to_outline(outline, p) >= width;
      grooves.push_back(prism(groove, -depth, depth));
    }
    if (fits) return grooves;
  }
  return {};
}

}  // namespace formwright
