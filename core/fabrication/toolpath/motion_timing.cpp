// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include "fabrication/toolpath/toolpath.h"

namespace formwright {
namespace {

struct Block {
  Vec3 direction;
  double length_mm, speed_mm_per_s;
};

constexpr double unlimited = std::numeric_limits<double>::max();

/// grbl 1.1, planner.c: v^2 = a d s / (1 - s) with s = sin(theta / 2) of the corner's inner angle theta.
double corner_speed_squared(const Vec3& before, const Vec3& after, const MotionLimits& limits) {
  const double cosine = -before.dot(after);  // of theta
  if (cosine > 0.999999) return 0;           // straight back
  if (cosine < -0.999999) return unlimited;  // straight on
  const double half_sine = std::sqrt(0.5 * (1 - cosine));
  return limits.acceleration_mm_per_s2 * limits.junction_deviation_mm * half_sine / (1 - half_sine);
}

double block_seconds(const Block& block, double entry_squared, double exit_squared, double acceleration) {
  const double nominal_squared = block.speed_mm_per_s * block.speed_mm_per_s;
  const double peak_squared =
      std::min(nominal_squared, (2 * acceleration * block.length_mm + entry_squared + exit_squared) / 2);
  const double peak = std::sqrt(peak_squared), entry = std::sqrt(entry_squared), exit = std::sqrt(exit_squared);
  const double ramps_mm = (2 * peak_squared - entry_squared - exit_squared) / (2 * acceleration);
  return (2 * peak - entry - exit) / acceleration + std::max(0.0, block.length_mm - ramps_mm) / peak;
}

}  // namespace

void time_moves(Toolpath& path, const MotionLimits& limits) {
  std::vector<Block> blocks;
  for (const ToolMove& move : path.moves)
    for (std::size_t i = 1; i < move.points_mm.size(); ++i) {
      const Vec3 step = move.points_mm[i] - move.points_mm[i - 1];
      const double length = step.norm();
      blocks.push_back({length > 0 ? Vec3(step / length) : Vec3(0, 0, 0), length, std::max(move.speed_mm_per_s, 1e-3)});
    }
  const double a = limits.acceleration_mm_per_s2;
  const std::size_t n = blocks.size();
  // While a block runs, the controller knows planner_blocks - 1 more and plans to stand still behind the last of them.
  // That caps the speed at every junction by the path left there; with these caps one pass over the whole job gives
  // what its moving window gives.
  const std::size_t ahead = static_cast<std::size_t>(std::max(1, limits.planner_blocks - 1));
  std::vector<double> from_start(n + 1, 0), speed_squared(n + 1, 0);  // speed_squared[i]: on entering block i
  for (std::size_t i = 0; i < n; ++i) from_start[i + 1] = from_start[i] + blocks[i].length_mm;
  for (std::size_t i = 1; i < n; ++i) {
    const double nominal = std::min(blocks[i - 1].speed_mm_per_s, blocks[i].speed_mm_per_s);
    const double seen_mm = from_start[std::min(n, i + ahead)] - from_start[i];
    speed_squared[i] =
        std::min({nominal * nominal, corner_speed_squared(blocks[i - 1].direction, blocks[i].direction, limits),
                  2 * a * seen_mm});
  }
  for (std::size_t i = n; i-- > 0;)
    speed_squared[i] = std::min(speed_squared[i], speed_squared[i + 1] + 2 * a * blocks[i].length_mm);
  for (std::size_t i = 0; i < n; ++i)
    speed_squared[i + 1] = std::min(speed_squared[i + 1], speed_squared[i] + 2 * a * blocks[i].length_mm);

  double now_s = 0;
  std::size_t at = 0;
  for (ToolMove& move : path.moves) {
    move.times_s.assign(1, now_s);
    for (std::size_t i = 1; i < move.points_mm.size(); ++i, ++at) {
      if (blocks[at].length_mm > 0) now_s += block_seconds(blocks[at], speed_squared[at], speed_squared[at + 1], a);
      move.times_s.push_back(now_s);
    }
  }
  path.seconds = now_s;
}

}  // namespace formwright
