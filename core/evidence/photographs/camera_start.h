// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// First guesses for a bundle adjustment: cameras from the plane of the board [Zha00], points from rays.
#include <optional>
#include <span>
#include <vector>

#include "evidence/photographs/camera.h"
#include "evidence/photographs/plane_map.h"

namespace formwright {

/// The focal length, in pixels, that makes the maps' axes perpendicular and equally long on the average; the maps go
/// from the plane to pixels from the picture's middle. None where all photographs look straight down.
std::optional<double> focal_of_maps(std::span<const PlaneMap> maps, double scale_px);

/// The pose in which a camera of this focal length sees the plane z = plane_z_mm as `map` says.
std::optional<Pose> pose_of_map(const PlaneMap& map, double focal_px, double plane_z_mm);

/// A ray of sight in machine coordinates.
struct SightRay {
  Vec3 origin, direction;  // of length 1
};

/// The point nearest to the rays; none for fewer than two, or where they are parallel.
std::optional<Vec3> nearest_point(std::span<const SightRay> rays);
/// The largest angle between two of the rays.
double widest_angle_rad(std::span<const SightRay> rays);

}  // namespace formwright
