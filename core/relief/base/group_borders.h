// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Where a relief whose parts move in groups, eq. (3.11), is cut: planes through the viewpoint, one beside the other.
#include <optional>

#include "relief/base/base_bands.h"
#include "relief/base/depth_bounds.h"

namespace formwright {

/// Bands of rays from left to right with a plane through the viewpoint between each and the next. All points are in
/// view coordinates.
class GroupBorders {
 public:
  virtual ~GroupBorders() = default;
  virtual int bands() const = 0;
  /// Which group of DepthBounds a band moves with; -1: the band is left out.
  virtual int group(int band) const = 0;
  /// The same at every point of a ray, and growing from band to band.
  virtual double place(const Vec3& p) const = 0;
  /// The place between `border` and `border` + 1.
  virtual double border(int border) const = 0;
  /// Linear in `p`, and 0 on the border's plane.
  virtual double off(int border, const Vec3& p) const = 0;
  /// Nearest and farthest depth z of a new vertex `p` on a border, in the part on `band`'s side; nothing: free.
  /// `held`: whether both ends of the edge that it lies on are held by bounds.
  virtual std::optional<Vec2> limits(int band, int border, const Vec3& p, bool held) const = 0;
};

/// Those of a base in steps or strips. What is given must outlive it.
class BandBorders : public GroupBorders {
 public:
  BandBorders(const ViewFrame& frame, const BaseBands& bands, const DepthBounds& bounds)
      : frame_(frame), bands_(bands), bounds_(bounds) {}

  int bands() const override { return bands_.count(); }
  int group(int band) const override { return band; }
  double place(const Vec3& p) const override { return bands_.on_plate(frame_, p); }
  double border(int border) const override { return bands_.border_on_plate(frame_, border); }
  double off(int border, const Vec3& p) const override {
    return bands_.across(p.x(), p.y()) - this->border(border) * (1 + frame_.kappa * p.z());
  }
  std::optional<Vec2> limits(int band, int, const Vec3& p, bool held) const override {
    if (!held) return std::nullopt;
    return Vec2(bands_.depth_on_ray(frame_, band, p, -bounds_.above),
                bands_.depth_on_ray(frame_, band, p, bounds_.below));
  }

 private:
  const ViewFrame& frame_;
  const BaseBands& bands_;
  const DepthBounds& bounds_;
};

}  // namespace formwright
