// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A base in planes: bands across the plate, each a plane of its own. Steps lie at growing depths; strips lean to one
// side or the other, and neighbours meet at their border. Rays that meet different bands move in groups of their own,
// thesis eq. (3.11) and Fig. 3.7.
#include <cmath>
#include <vector>

#include "relief/view/view_frame.h"

namespace formwright {

class BaseBands {
 public:
  /// `depth`: z of each band, in the order of the place t across the plate, at least one; `border`: t between each and
  /// the next, ascending; `turn_deg`: of the direction in which t is measured, from x towards y. `slope`: dz / dt of
  /// each band, whose `depth` then counts at t = 0; empty for steps, whose depths ascend.
  BaseBands(std::vector<double> depth, std::vector<double> border, double turn_deg, std::vector<double> slope = {});

  int count() const { return static_cast<int>(depth_.size()); }
  double depth(int band) const { return depth_[static_cast<std::size_t>(band)]; }
  double depth(int band, double t) const { return depth(band) + slope(band) * t; }
  double slope(int band) const { return slope_[static_cast<std::size_t>(band)]; }
  /// Length along z of one unit of length along the band's normal.
  double along_z(int band) const { return std::sqrt(1 + slope(band) * slope(band)); }
  const std::vector<double>& border() const { return border_; }
  Vec2 across() const { return {cos_, sin_}; }
  double across(double x, double y) const { return cos_ * x + sin_ * y; }

  /// Depth at which the ray from the viewpoint through `p` meets the plane of a band, moved by `shift` along its normal
  /// away from the viewer. Infinite or behind the viewpoint where it does not.
  double depth_on_ray(const ViewFrame& frame, int band, const Vec3& p, double shift) const;
  /// The band below a point of the plate.
  int of_point(double x, double y) const;
  /// The band, or the wall before it, that the ray from the viewpoint through `p` meets.
  int of_ray(const ViewFrame& frame, const Vec3& p) const;
  /// What of_ray compares: where the ray crosses the plane z = 0, and where the rays past the border's nearer edge do.
  double on_plate(const ViewFrame& frame, const Vec3& p) const;
  double border_on_plate(const ViewFrame& frame, int border) const;

 private:
  std::vector<double> depth_, border_, slope_;
  double cos_ = 1, sin_ = 0;
};

}  // namespace formwright
