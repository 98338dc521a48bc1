// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "evidence/registration/calibration_pattern.h"

namespace formwright::test {

/// Few marks on a small sheet: quick to draw and to find.
inline CalibrationPattern small_pattern() {
  CalibrationPatternOptions options;
  options.sheet_x_mm = 120;
  options.sheet_y_mm = 130;
  options.clamp_opening_x_mm = 106;
  options.clamp_opening_y_mm = 116;
  options.coarsest_mm = 20;
  return make_calibration_pattern(options);
}

}  // namespace formwright::test
