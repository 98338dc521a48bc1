// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A photograph's colours back to those that were printed, from places where both are known.
#include <Eigen/Core>
#include <array>
#include <span>

#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

struct ColourSample {
  Vec2 place;     // -1 to 1 across the picture
  Vec3 seen;      // linear light, 1 is white
  Vec3 expected;  // linear light
};

/// expected = matrix * (seen / light(place)) + offset, light = exp of a polynomial of second degree without constant: a
/// lamp to one side, a dark rim.
struct ColourCorrection {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
  Vec3 offset = Vec3::Zero();
  std::array<double, 5> log_light{};  // of x, y, x^2, x y, y^2
  double rms_levels = 0;              // left over, in grey levels of sRGB, over the samples that were not rejected
  int rejected = 0;                   // samples that fit nothing else

  double light(const Vec2& place) const;
  Vec3 operator()(const Vec3& seen, const Vec2& place) const { return matrix * (seen / light(place)) + offset; }
};

/// Robust (Tukey's weights), so that a patch out of sight spoils nothing. Needs at least 8 samples; with fewer than 30
/// the light stays even, and with fewer than 12 the matrix diagonal. Throws Error{could_not_solve} where the samples
/// have no contrast.
ColourCorrection fit_colour_correction(std::span<const ColourSample> samples);

}  // namespace formwright
