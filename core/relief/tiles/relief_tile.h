// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The tiles that a relief on steps or strips is made of: each carries what is seen through its part of the picture.
#include <optional>
#include <vector>

#include "relief/base/base_bands.h"
#include "relief/height_map.h"
#include "relief/view/view_frame.h"

namespace formwright {

/// From view coordinates to those of the tiles: mm, x right, y up, z towards the viewer, the middle of the plate's
/// front at the origin.
Positions to_scene(const Positions& view_positions, double size_mm);

/// One plane of the base, cut where rays from the viewpoint leave it. All in mm.
struct ReliefTile {
  int band = 0;               // of BaseBands
  Vec3 origin, right, up;     // a point of the plane, and where right and up lie in it as seen from the front
  Vec3 normal;                // towards the viewer
  std::optional<Vec3> eye;    // nothing: straight on, along -z
  std::vector<Vec2> outline;  // convex, counter-clockwise, coordinates along `right` and `up` from `origin`

  /// A place of the plane.
  Vec3 on_plane(const Vec2& place) const { return origin + place.x() * right + place.y() * up; }
  /// The place `height_mm` before the plane, measured along its normal, on the ray through a place of the plane.
  Vec3 raised(const Vec2& place, double height_mm) const;
  /// `towards`: the unit vector from a point of the plane back to the viewpoint.
  Vec3 towards_eye(const Vec3& point) const;

  double area_mm2() const;
  Vec2 lower() const;  // of the outline's box
  Vec2 upper() const;
  /// How far its plane's middle lies behind the foremost place of the base.
  double depth_mm() const { return -on_plane(0.5 * (lower() + upper())).z(); }
  /// How far it is turned against the plate; 0 on steps.
  double turn_deg() const;
};

/// One tile for each band that is seen through the plate's front, z = 0, in reading order: from left to right where the
/// bands lie side by side, else from top to bottom. Their parts of the picture cover the plate's front once.
std::vector<ReliefTile> relief_tiles(const ViewFrame& frame, const BaseBands& bands, PlateSize plate, double size_mm);

}  // namespace formwright
