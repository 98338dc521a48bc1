// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/svg/grammar/curve_flattening.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace formwright {
namespace {

constexpr int max_steps = 100'000;  // of one curve

/// Coordinates in whole nanometres: the last bits of sines, which differ between machines, do not reach a drawing.
Vec2 snapped(const Vec2& p) { return {std::round(1e6 * p.x()) / 1e6, std::round(1e6 * p.y()) / 1e6}; }

}  // namespace

Vec2 CurveFlattener::in_reach(const Vec2& p) const {
  const Vec2 mm = to_mm_ * p;
  // Written so that NaN fails.
  if (!(std::abs(mm.x()) <= max_coordinate_mm && std::abs(mm.y()) <= max_coordinate_mm))
    refuse_drawing("The drawing reaches farther than 20 m, to over 1 km: check its units and its transforms.");
  return mm;
}

void CurveFlattener::add(const Vec2& p) {
  current_ = p;
  const Vec2 mm = snapped(in_reach(p));
  auto& points = subpaths_.back().points_mm;
  if (!points.empty() && points.back() == mm) return;
  limits_.add_points(1);
  points.push_back(mm);
}

void CurveFlattener::begin_if_closed() {
  if (open_) return;
  limits_.add_path();
  subpaths_.emplace_back();
  open_ = true;
  add(start_);
}

void CurveFlattener::move_to(const Vec2& p) {
  start_ = current_ = p;
  open_ = false;
}

void CurveFlattener::line_to(const Vec2& p) {
  begin_if_closed();
  add(p);
}

void CurveFlattener::cubic_to(const Vec2& control_1, const Vec2& control_2, const Vec2& p) {
  begin_if_closed();
  in_reach(control_1);
  in_reach(control_2);
  const Vec2 from = current_;
  const auto bend_mm = [&](const Vec2& a, const Vec2& b, const Vec2& c) {
    return (to_mm_.linear() * (a - 2 * b + c)).norm();
  };
  const double bend = std::max(bend_mm(from, control_1, control_2), bend_mm(control_1, control_2, p));
  const double wanted = std::ceil(std::sqrt(6 * bend / (8 * tolerance_mm_)));
  const int steps = static_cast<int>(std::clamp(wanted, 1.0, static_cast<double>(max_steps)));
  limits_.add_steps(static_cast<std::size_t>(steps));
  for (int i = 1; i < steps; ++i) {
    const double t = static_cast<double>(i) / steps, s = 1 - t;
    add(s * s * s * from + 3 * s * s * t * control_1 + 3 * s * t * t * control_2 + t * t * t * p);
  }
  add(p);
}

int CurveFlattener::arc_steps(double largest_radius, double angle) const {
  const Eigen::Matrix2d square = to_mm_.linear().transpose() * to_mm_.linear();
  const double half_trace = square.trace() / 2;
  const double scale = std::sqrt(half_trace + std::sqrt(std::max(0.0, half_trace * half_trace - square.determinant())));
  const double step = std::sqrt(8 * tolerance_mm_ / std::max(largest_radius * scale, 1e-9));
  return static_cast<int>(std::clamp(std::ceil(std::abs(angle) / std::min(step, std::numbers::pi / 4)), 1.0,
                                     static_cast<double>(max_steps)));
}

void CurveFlattener::arc_to(double rx, double ry, double turn_degrees, bool large, bool sweep, const Vec2& p) {
  begin_if_closed();
  rx = std::abs(rx);
  ry = std::abs(ry);
  if (current_ == p) return;
  if (rx == 0 || ry == 0) return add(p);
  const Vec2 from = current_;
  const Eigen::Rotation2Dd turn(turn_degrees * std::numbers::pi / 180);
  const Vec2 half = turn.inverse() * Vec2((from - p) / 2);
  const double excess = half.x() * half.x() / (rx * rx) + half.y() * half.y() / (ry * ry);  // (F.6.6.2)
  if (excess > 1) {
    rx *= std::sqrt(excess);
    ry *= std::sqrt(excess);
  }
  // On the unit circle, chord from u to -u: its centre lies across the chord (F.6.5.2).
  const Vec2 u(half.x() / rx, half.y() / ry);
  const double length_squared = u.squaredNorm();
  if (!(length_squared > 1e-16) && !large) return add(p);  // of so large a circle it is a straight line
  const double across = std::sqrt(std::max(0.0, 1 / length_squared - 1)) * (large == sweep ? -1 : 1);
  const Vec2 centre(across * u.y(), -across * u.x());
  const Vec2 a = u - centre, b = -u - centre;
  const double first = std::atan2(a.y(), a.x());
  double angle = std::atan2(b.y(), b.x()) - first;
  if (sweep && angle < 0) angle += 2 * std::numbers::pi;
  if (!sweep && angle > 0) angle -= 2 * std::numbers::pi;
  const auto back = [&](const Vec2& unit) -> Vec2 {
    return (from + p) / 2 + turn * Vec2(rx * unit.x(), ry * unit.y());
  };
  const int steps = arc_steps(std::max(rx, ry), angle);
  for (int i = 1; i < steps; ++i) {
    const double at = first + angle * i / steps;
    add(back(centre + Vec2(std::cos(at), std::sin(at))));
  }
  add(p);
}

void CurveFlattener::ellipse(const Vec2& centre, double rx, double ry) {
  move_to(centre + Vec2(rx, 0));
  begin_if_closed();
  const int steps =
      4 * ((arc_steps(std::max(rx, ry), 2 * std::numbers::pi) + 3) / 4);  // so that all four extremes are corners
  for (int i = 1; i < steps; ++i) {
    const double at = 2 * std::numbers::pi * i / steps;
    add(centre + Vec2(rx * std::cos(at), ry * std::sin(at)));
  }
  close();
}

void CurveFlattener::close() {
  if (open_) {
    Subpath& subpath = subpaths_.back();
    subpath.closed = true;
    while (subpath.points_mm.size() > 1 && (subpath.points_mm.back() - subpath.points_mm.front()).norm() < 1e-5)
      subpath.points_mm.pop_back();
  }
  open_ = false;
  current_ = start_;
}

std::vector<CurveFlattener::Subpath> CurveFlattener::take() {
  std::vector<Subpath> result;
  for (Subpath& subpath : subpaths_) {
    if (subpath.points_mm.size() < 2) continue;
    // A contour drawn back to its start is closed, whether it says so or not.
    if (!subpath.closed && subpath.points_mm.size() > 3 &&
        (subpath.points_mm.back() - subpath.points_mm.front()).norm() < 1e-5) {
      subpath.points_mm.pop_back();
      subpath.closed = true;
    }
    if (subpath.closed && subpath.points_mm.size() == 2) subpath.closed = false;  // there and back is one line
    result.push_back(std::move(subpath));
  }
  subpaths_.clear();
  open_ = false;
  return result;
}

}  // namespace formwright
