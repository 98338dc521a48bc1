// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/curve/line_trace.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"

namespace formwright {

Vec3 TracedLine::at(double x) const {
  const auto above = std::upper_bound(x_mm.begin(), x_mm.end(), x);
  if (above == x_mm.begin()) return position_mm.front();
  if (above == x_mm.end()) return position_mm.back();
  const auto i = static_cast<std::size_t>(above - x_mm.begin());
  const double t = (x - x_mm[i - 1]) / (x_mm[i] - x_mm[i - 1]);
  return (1 - t) * position_mm[i - 1] + t * position_mm[i];
}

LineTracer::LineTracer(const Segmentation& s, const Parameterisation& p)
    : s_(s), p_(p), adjacency_(s.mesh), lower_(s.part_count()), upper_(s.part_count()) {
  for (int h = 0; h < 3 * s.mesh.face_count(); ++h) {
    const int o = adjacency_.opposite(h), part = s.face_segment[h / 3];
    if (o >= 0 && s.face_segment[o / 3] == part) continue;
    // Lower lines are walked towards larger x, upper ones towards smaller.
    const bool upper = p.corners_mm(next_halfedge(h), 0) < p.corners_mm(h, 0);
    LineSides& line = upper ? upper_[part] : lower_[part];
    line.halfedge.push_back(h);
    line.x.push_back(p.corners_mm(upper ? next_halfedge(h) : h, 0));
  }
  for (auto* lines : {&lower_, &upper_})
    for (LineSides& line : *lines) {
      std::vector<std::size_t> order(line.x.size());
      std::iota(order.begin(), order.end(), std::size_t{0});
      std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return line.x[a] < line.x[b]; });
      LineSides sorted;
      for (const std::size_t i : order) sorted.x.push_back(line.x[i]), sorted.halfedge.push_back(line.halfedge[i]);
      line = std::move(sorted);
    }
}

LineTracer::Side LineTracer::side_at(int part, bool upper, double x) const {
  // Sides of one line cover one period, but those left of the part's cut may be a period on: look one back, too.
  const LineSides& line = upper ? upper_[part] : lower_[part];
  const double period = p_.period_mm[part];
  const double turns = std::floor((x - line.x.front()) / period);
  for (const double shift : {turns * period, (turns - 1) * period, (turns + 1) * period}) {
    const double wanted = x - shift;
    auto above = std::upper_bound(line.x.begin(), line.x.end(), wanted);
    if (above == line.x.begin()) continue;
    const auto i = static_cast<std::size_t>(above - line.x.begin()) - 1;
    const int h = line.halfedge[i];
    const double end = p_.corners_mm(upper ? h : next_halfedge(h), 0);
    if (wanted < end) return {h, shift};
  }
  // Between two sides by rounding: the nearest one.
  const double wanted = x - turns * period;
  const auto i = static_cast<std::size_t>(std::upper_bound(line.x.begin(), line.x.end(), wanted) - line.x.begin());
  return {line.halfedge[i == 0 ? 0 : i - 1], turns * period};
}

Vec3 LineTracer::on_line(int part, bool upper, double x) const {
  const Side side = side_at(part, upper, x);
  const int a = side.halfedge, b = next_halfedge(a);
  const double xa = p_.corners_mm(a, 0) + side.shift, xb = p_.corners_mm(b, 0) + side.shift;
  const double t = std::clamp((x - xa) / (xb - xa), 0.0, 1.0);
  return (1 - t) * s_.mesh.V.row(adjacency_.from(a)).transpose() + t * s_.mesh.V.row(adjacency_.to(a)).transpose();
}

TracedLine LineTracer::trace(int part, double x_low, double x_high) const {
  const double height = p_.height_mm[part];
  const Vec2 start(x_low, 0), along(x_high - x_low, height);
  const double squared_length = along.squaredNorm();
  TracedLine line;
  const auto add = [&](double x, const Vec3& position) {
    if (!line.x_mm.empty() && x <= line.x_mm.back()) x = std::nextafter(line.x_mm.back(), 1e300);
    line.x_mm.push_back(x);
    line.position_mm.push_back(position);
  };
  const auto point = [&](int corner, double shift) {
    return Vec2(p_.corners_mm(corner, 0) + shift, p_.corners_mm(corner, 1));
  };
  const auto side_of = [&](const Vec2& q) {
    return along.x() * (q.y() - start.y()) - along.y() * (q.x() - start.x());
  };  // > 0: left
  add(x_low, on_line(part, false, x_low));
  auto [h, shift] = side_at(part, false, x_low);
  const int maximum =
      4 * s_.mesh.face_count() + static_cast<int>(8.0 * (x_high - x_low) / p_.period_mm[part] * s_.mesh.face_count());
  for (int step = 0; step < maximum; ++step) {
    // Entering over h, whose start lies left of the path and whose end right: the third corner decides how to leave.
    const int next = next_halfedge(h), last = previous_halfedge(h);
    const bool apex_left = side_of(point(last, shift)) >= 0;
    const int out = apex_left ? next : last;
    const int left = apex_left ? last : h, right = apex_left ? next : last;
    const Vec2 pl = point(left, shift), pr = point(right, shift);
    const double sl = std::max(side_of(pl), 0.0), sr = std::max(-side_of(pr), 0.0);
    const double t = sl + sr > 0 ? sl / (sl + sr) : 0.5;
    const Vec3 position = (1 - t) * s_.mesh.V.row(adjacency_.from(left)).transpose() +
                          t * s_.mesh.V.row(adjacency_.from(right)).transpose();
    const int o = adjacency_.opposite(out);
    if (o < 0 || s_.face_segment[o / 3] != part) {
      if (std::abs((1 - t) * pl.y() + t * pr.y() - height) > 1e-6 * height) break;  // back at the lower line
      add(x_high, position);
      return line;
    }
    const Vec2 crossing = (1 - t) * pl + t * pr;
    add(std::clamp(start.x() + along.x() * (crossing - start).dot(along) / squared_length, x_low, x_high), position);
    // The other side's corners of the same edge, in the same turn.
    shift += p_.corners_mm(out, 0) - p_.corners_mm(next_halfedge(o), 0);
    h = o;
  }
  throw Error(
      ErrorCode::internal, "mesh",
      "The zipper's line could not be drawn across one part: subdivide the model, or divide it into other parts.");
}

}  // namespace formwright
