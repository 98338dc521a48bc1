// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/laser/laser_stroke.h"

#include <algorithm>
#include <cmath>

#include "fabrication/sheet/contours.h"

namespace formwright {
namespace {

/// A closed path by arc length.
class Ring {
 public:
  explicit Ring(std::vector<Vec2> points) : points_(std::move(points)), at_mm_{0} {
    for (std::size_t i = 0; i < points_.size(); ++i)
      at_mm_.push_back(at_mm_.back() + (points_[(i + 1) % points_.size()] - points_[i]).norm());
  }
  double length_mm() const { return at_mm_.back(); }
  const std::vector<double>& corners_mm() const { return at_mm_; }

  /// From one arc length to a later one, which may be past the end.
  std::vector<Vec2> piece(double from_mm, double to_mm) const {
    std::vector<Vec2> result{point(from_mm)};
    const std::size_t n = points_.size();
    for (double lap = 0; lap < to_mm; lap += length_mm())
      for (std::size_t i = 0; i < n; ++i)
        if (const double s = lap + at_mm_[i]; s > from_mm && s < to_mm) result.push_back(points_[i]);
    result.push_back(point(to_mm));
    return result;
  }

 private:
  Vec2 point(double s) const {
    s = std::fmod(s, length_mm());
    const auto i = static_cast<std::size_t>(std::upper_bound(at_mm_.begin(), at_mm_.end() - 1, s) - at_mm_.begin() - 1);
    const double run = at_mm_[i + 1] - at_mm_[i];
    const Vec2 &a = points_[i], &b = points_[(i + 1) % points_.size()];
    return run > 0 ? Vec2(a + (b - a) * ((s - at_mm_[i]) / run)) : a;
  }
  std::vector<Vec2> points_;
  std::vector<double> at_mm_;  // of every point, and of the end
};

std::vector<Vec3> at_height(const std::vector<Vec2>& points, double z_mm) {
  std::vector<Vec3> result;
  for (const Vec2& p : points) result.emplace_back(p.x(), p.y(), z_mm);
  return result;
}

}  // namespace

std::vector<double> place_tabs(const std::vector<Vec2>& closed_mm, int count, double clear_mm) {
  const Ring ring(closed_mm);
  const double length = ring.length_mm();
  count = std::min(count, static_cast<int>(length / (4 * std::max(clear_mm, 1e-6))));
  if (count < 1 || closed_mm.size() < 3) return {};
  constexpr double corner_cosine = 0.9659;  // of 15 degrees
  std::vector<double> avoid{0, length};
  const std::size_t n = closed_mm.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 in = closed_mm[i] - closed_mm[(i + n - 1) % n], out = closed_mm[(i + 1) % n] - closed_mm[i];
    if (in.dot(out) < corner_cosine * in.norm() * out.norm()) avoid.push_back(ring.corners_mm()[i]);
  }
  std::sort(avoid.begin(), avoid.end());
  const auto clearance = [&](double s) {
    const auto after = std::lower_bound(avoid.begin(), avoid.end(), s);
    double nearest = after == avoid.end() ? length : *after - s;
    if (after != avoid.begin()) nearest = std::min(nearest, s - *(after - 1));
    return nearest;
  };
  std::vector<double> tabs;
  const double spacing = length / count;
  constexpr int tries = 32;
  for (int k = 0; k < count; ++k) {
    double best_s = (k + 0.5) * spacing, best = -1;
    for (int t = 0; t <= 2 * tries; ++t) {  // 0, +1, -1, +2, -2, ...: the nearest place that is clear
      const double shift = (t % 2 == 1 ? 1 : -1) * ((t + 1) / 2) * spacing / (4 * tries);
      const double s = (k + 0.5) * spacing + shift, here = std::min(clearance(s), clear_mm);
      if (here > best + 1e-9) {
        best = here;
        best_s = s;
      }
    }
    tabs.push_back(best_s);
  }
  return tabs;
}

void run_stroke(ToolpathBuilder& builder, const LaserStroke& stroke, int first) {
  std::vector<Vec2> points = stroke.points_mm;
  if (stroke.closed) std::rotate(points.begin(), points.begin() + first, points.end());
  else if (first != 0) std::reverse(points.begin(), points.end());
  const auto work = [&](const std::vector<Vec2>& along, int pass) {
    ToolMove move;
    move.layer = stroke.layer;
    move.part = stroke.part;
    move.pass = pass + 1;
    move.power_percent = stroke.power_percent;
    move.speed_mm_per_s = stroke.speed_mm_per_s;
    move.points_mm = at_height(along, stroke.z_mm - pass * stroke.step_down_mm);
    builder.work(std::move(move));
  };
  if (!stroke.closed) {
    for (int pass = 0; pass < stroke.passes; ++pass) {
      work(points, pass);
      if (!stroke.fixed_direction) std::reverse(points.begin(), points.end());
    }
  } else {
    const Ring ring(points);
    const double length = ring.length_mm();
    for (int pass = 0; pass < stroke.passes; ++pass) {
      const bool last = pass + 1 == stroke.passes;
      double end = last ? length + std::min(stroke.overcut_mm, length) : length;
      double from = 0;
      if (last && stroke.tabs > 0) {
        const double half = stroke.tab_gap_mm / 2, z = stroke.z_mm - pass * stroke.step_down_mm;
        const std::vector<double> tabs = place_tabs(points, stroke.tabs, stroke.tab_gap_mm);
        if (!tabs.empty()) end = std::min(end, length + std::max(0.0, tabs.front() - half));
        for (const double middle : tabs) {
          work(ring.piece(from, middle - half), pass);
          builder.travel_along(at_height(ring.piece(middle - half, middle + half), z));
          from = middle + half;
        }
      }
      work(ring.piece(from, end), pass);
    }
  }
  // Travels between paths are at the surface's height.
  if (builder.at().z() != 0) builder.travel_to({builder.at().x(), builder.at().y(), 0});
}

}  // namespace formwright
