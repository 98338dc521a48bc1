// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/base/base_bands.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace formwright {

BaseBands::BaseBands(std::vector<double> depth, std::vector<double> border, double turn_deg, std::vector<double> slope)
    : depth_(std::move(depth)), border_(std::move(border)), slope_(std::move(slope)) {
  slope_.resize(depth_.size(), 0.0);
  const double angle = turn_deg * std::numbers::pi / 180;
  cos_ = std::cos(angle);
  sin_ = std::sin(angle);
}

double BaseBands::depth_on_ray(const ViewFrame& frame, int band, const Vec3& p, double shift) const {
  // z = depth + slope t + shift along z, where t = T (1 + kappa z) on the ray.
  const double steepness = slope(band) * on_plate(frame, p);
  return (depth(band) + shift * along_z(band) + steepness) / (1 - frame.kappa * steepness);
}

int BaseBands::of_point(double x, double y) const {
  return static_cast<int>(std::ranges::upper_bound(border_, across(x, y)) - border_.begin());
}

double BaseBands::on_plate(const ViewFrame& frame, const Vec3& p) const {
  return across(p.x(), p.y()) / (1 + frame.kappa * p.z());
}

double BaseBands::border_on_plate(const ViewFrame& frame, int border) const {
  // The near edge of the wall hides its foot, or the wall is seen from there on.
  const double t = border_[static_cast<std::size_t>(border)];
  return t / (1 + frame.kappa * depth(border, t));
}

int BaseBands::of_ray(const ViewFrame& frame, const Vec3& p) const {
  const double t = on_plate(frame, p);
  int band = 0;
  while (band + 1 < count() && t >= border_on_plate(frame, band)) ++band;
  return band;
}

}  // namespace formwright
