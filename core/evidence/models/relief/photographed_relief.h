// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A photograph of a finished relief in known light: its surface, its set-up and the brightness of its points.
#include <optional>
#include <string>
#include <vector>

#include "base/bytes.h"
#include "evidence/models/relief/relief_surface.h"

namespace formwright {

struct ShadedPoint {
  Vec2 place_mm;
  double brightness;  // linear, of the whole picture's own scale
  double sigma;       // of the same; 0 where unknown
};

/// How the picture was taken, as far as it is known.
struct ShadingSetup {
  Vec3 light_direction = Vec3(-1, 1, 1);  // towards the light
  double light_distance_mm = 0;           // 0: very far
  double camera_height_mm = 0;            // above the relief's middle; 0: very far
  /// Height (z) of the plane in which the picture's places are true: the one that it was straightened to. Half-way
  /// between the lowest and the highest place of the relief where it is not given.
  std::optional<double> straightened_at_mm;
};

struct PhotographedRelief {
  std::string name;
  ReliefSurface surface;
  ShadingSetup setup;
  std::vector<ShadedPoint> points;
};

/// shading.csv: header x_mm,y_mm,brightness[,sigma]. Throws Error{invalid_input, "object"} with the line.
std::vector<ShadedPoint> read_shaded_points(ByteView csv);
/// setup.json: light_direction [x, y, z], light_distance_mm, camera_height_mm, straightened_at_mm. Throws
/// Error{invalid_input, "object"}, naming the key.
ShadingSetup read_shading_setup(ByteView json);

}  // namespace formwright
