// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A base in steps: bands across the plate, each a plane of its own depth, which grows from band to band. Rays that meet
// different bands move in groups of their own, thesis eq. (3.11) and Fig. 3.7.
#include <vector>

#include "relief/view/view_frame.h"

namespace formwright {

class BaseBands {
 public:
  /// `depth`: z of each band, ascending, in the order of the place t across the plate, at least one; `border`: t
  /// between each and the next, ascending; `turn_deg`: of the direction in which t is measured, from x towards y.
  BaseBands(std::vector<double> depth, std::vector<double> border, double turn_deg);

  int count() const { return static_cast<int>(depth_.size()); }
  double depth(int band) const { return depth_[static_cast<std::size_t>(band)]; }
  const std::vector<double>& border() const { return border_; }
  double across(double x, double y) const { return cos_ * x + sin_ * y; }

  /// The band below a point of the plate.
  int of_point(double x, double y) const;
  /// The band, or the wall before it, that the ray from the viewpoint through `p` meets.
  int of_ray(const ViewFrame& frame, const Vec3& p) const;
  /// What of_ray compares: where the ray crosses the plane z = 0, and where the rays past the border's nearer edge do.
  double on_plate(const ViewFrame& frame, const Vec3& p) const;
  double border_on_plate(const ViewFrame& frame, int border) const;

 private:
  std::vector<double> depth_, border_;
  double cos_ = 1, sin_ = 0;
};

}  // namespace formwright
