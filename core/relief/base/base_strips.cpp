// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/base/base_strips.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace formwright {
namespace {

constexpr double max_turn_deg = 75;  // of a strip against the plate
constexpr double min_facing = 0.2;   // of the ray's direction along a strip's normal, where it is seen flattest
constexpr double degree = std::numbers::pi / 180;

[[noreturn]] void refuse(int strip) {
  throw Error(ErrorCode::invalid_input, "base_fold_deg",
              "Strip " + std::to_string(strip + 1) +
                  " would be seen from its edge: make the angle between strips smaller, or take fewer of them.");
}

/// Of each strip against the plate, positive where its right side lies farther away.
std::vector<double> turns_deg(const ReliefOptions& options) {
  std::vector<double> turns;
  const double middle = 0.5 * (options.base_steps - 1);
  for (int k = 0; k < options.base_steps; ++k) {
    const double folds = options.base_bend == BaseBend::bay ? k - middle : k % 2 == 0 ? -0.5 : 0.5;
    turns.push_back(folds * options.base_fold_deg);
    if (std::abs(turns.back()) > max_turn_deg) refuse(k);
  }
  return turns;
}

}  // namespace

BaseStrips base_strips(const ReliefOptions& options, const ViewFrame& frame, double half_across, double turn_deg) {
  const std::vector<double> turns = turns_deg(options);
  // Ends and folds for strips of width 1, the first end at t = 0 and the foremost of them at z = 0.
  std::vector<double> t{0}, z{0};
  for (const double turn : turns) {
    t.push_back(t.back() + std::cos(turn * degree));
    z.push_back(z.back() + std::sin(turn * degree));
  }
  const double foremost = *std::ranges::min_element(z);
  for (double& depth : z) depth -= foremost;
  // t_first = -half (1 + kappa w z_first) and t_last = half (1 + kappa w z_last): the ends lie on the rays through the
  // plate's ends.
  const double narrowed = t.back() - frame.kappa * half_across * (z.front() + z.back());
  if (!(narrowed > 0)) refuse(0);
  const double width = 2 * half_across / narrowed, first = -half_across * (1 + frame.kappa * width * z.front());
  std::vector<double> depth, slope;
  for (std::size_t k = 0; k < t.size(); ++k) {
    t[k] = first + width * t[k];
    z[k] *= width;
  }
  for (std::size_t k = 0; k < turns.size(); ++k) {
    slope.push_back(std::tan(turns[k] * degree));
    depth.push_back(z[k] - slope[k] * t[k]);
    for (const std::size_t end : {k, k + 1}) {
      const Vec2 ray = Vec2(frame.kappa * t[end], 1 + frame.kappa * z[end]).normalized();
      if (!(ray.dot(Vec2(-slope[k], 1).normalized()) >= min_facing)) refuse(static_cast<int>(k));
    }
  }
  const std::vector<double> folds(t.begin() + 1, t.end() - 1);
  return {BaseBands(depth, folds, turn_deg, slope), t, z};
}

}  // namespace formwright
