// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The four corner marks of the pattern, found in a scan laid flat.
#include <array>
#include <Eigen/Core>

#include "evidence/registration/calibration_pattern.h"
#include "evidence/registration/scan_picture.h"

namespace formwright {

struct FoundMarks {
  std::array<Vec2, 4> place_mm;  // in the plane of the flat scan
  std::array<double, 4>
      similarity{};       // correlation with the mark, -1 to 1; 0 for one that was guessed from the other three
  bool mirrored = false;  // the scan's faces look inwards: the plane was seen from below
};

/// Correlates the picture (linear light, in `frame`) with every mark over a range of sizes, and takes the four that
/// look most alike while their distances are those of the pattern within a third. One of them may be out of sight.
/// Throws Error{invalid_input, "corners"} when fewer than three are found.
FoundMarks find_marks(const CalibrationPattern& pattern, const WeightedPicture& flat, const PlaneFrame& frame,
                      Context& context);

/// The homography that maps four points to four others: (x, y, 1) -> (x', y', 1) up to scale.
/// Throws Error{invalid_input, "corners"}: three of them on a line, or in the wrong order.
Eigen::Matrix3d homography(const std::array<Vec2, 4>& from, const std::array<Vec2, 4>& to);
Vec2 mapped(const Eigen::Matrix3d& homography, const Vec2& point);

}  // namespace formwright
