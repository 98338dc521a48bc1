// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/svg/dashes.h"

#include <cmath>
#include <numeric>

namespace formwright {

std::vector<CurveFlattener::Subpath> break_into_dashes(const CurveFlattener::Subpath& subpath,
                                                       const DashPattern& pattern, const Eigen::Matrix2d& measure,
                                                       DrawingLimits& limits) {
  using Subpath = CurveFlattener::Subpath;
  const std::vector<double>& lengths = pattern.lengths;
  const double period = std::accumulate(lengths.begin(), lengths.end(), 0.0);
  double into = std::fmod(pattern.offset, period);
  if (into < 0) into += period;
  std::size_t phase = 0;
  while (phase + 1 < lengths.size() && into >= lengths[phase]) into -= lengths[phase++];
  double left = std::max(lengths[phase] - into, 0.0);  // of this dash or gap

  std::vector<Subpath> pieces;
  Subpath piece;
  const auto add = [&](const Vec2& p) {
    if (!piece.points_mm.empty() && piece.points_mm.back() == p) return;
    limits.add_points(1);
    piece.points_mm.push_back(p);
  };
  const auto end_piece = [&] {
    if (piece.points_mm.size() > 1) {
      limits.add_path();
      pieces.push_back(std::move(piece));
    }
    piece = {};
  };
  const auto& points = subpath.points_mm;
  const std::size_t segments = subpath.closed ? points.size() : points.size() - 1;
  for (std::size_t i = 0; i < segments; ++i) {
    const Vec2 a = points[i], b = points[(i + 1) % points.size()];
    const double length = (measure * (b - a)).norm();
    double at = 0;
    if (phase % 2 == 0) add(a);
    while (at + left < length) {
      at += left;
      const Vec2 p = a + at / length * (b - a);
      if (phase % 2 == 0) {
        add(p);
        end_piece();
      }
      limits.add_steps(64);
      phase = (phase + 1) % lengths.size();
      left = lengths[phase];
      if (phase % 2 == 0) add(p);
    }
    left -= length - at;
    if (phase % 2 == 0) add(b);
  }
  end_piece();
  return pieces;
}

}  // namespace formwright
