// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// From marks found in photographs to cameras, lens and points.
#include <set>

#include "evidence/photographs/bundle.h"
#include "evidence/photographs/photograph_reading.h"

namespace formwright {

/// The photographs used and all corners of sheet marks that two of them see.
struct PhotographSolution {
  Bundle bundle;
  BundleFit fit;
  std::vector<int> photograph_of_camera;
  std::vector<int> point_of_corner;  // 4 per mark of the sheet: index into bundle.points, -1 where there is none
  std::set<int> narrow_marks;        // of the sheet, seen from one place only
  std::vector<double> angle_rad;     // per point: the largest between two of its rays
  std::vector<double> shared_px;     // per point: BundleObservation::shared_px, the mean of its observations
  std::vector<double> camera_rms_px;
  int outliers = 0;
};

/// `board_scale`: printed length of nominal. Photographs that show too little of the board are left out, with a note.
/// Throws Error: invalid_input (fewer than two photographs show the board), could_not_solve, cancelled.
PhotographSolution solve_photographs(const std::vector<ReadPhotograph>& photographs, const MarkSheet& sheet,
                                     double board_scale, double board_z_mm, std::vector<std::string>& notes,
                                     Context& context);

}  // namespace formwright
