// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What printing the pattern and scanning the object add to what the machine did. 0 where absent.
#include <tuple>

#include "base/parameters.h"

namespace formwright {

struct MeasurementEffects {
  static constexpr std::string_view group_title = "Measurement's own ways";

  double print_scale = 0;  // the sheet's true coordinates are (1 + print_scale) times those in measured.csv
  double scan_scale = 0;   // measured = (1 + scan_scale) true + shift, about the origin on the raised base plate
  double scan_shift_x_mm = 0;
  double scan_shift_y_mm = 0;
  double scan_shift_z_mm = 0;

  static constexpr auto parameters = std::tuple{
      parameter("print_scale", &MeasurementEffects::print_scale, "Print too large by", unit::none, -0.2, 0.2,
                "Share by which the pattern on the sheet was printed too large.")
          .group(group_title)
          .slider(-0.05, 0.05)
          .advanced(),
      parameter("scan_scale", &MeasurementEffects::scan_scale, "Scan too large by", unit::none, -0.2, 0.2,
                "Share by which measured places are farther than they are from the centre of the opening on the plate.")
          .group(group_title)
          .slider(-0.05, 0.05)
          .advanced(),
      parameter("scan_shift_x_mm", &MeasurementEffects::scan_shift_x_mm, "Scan off in x", unit::mm, -100, 100,
                "Measured less true.")
          .group(group_title)
          .slider(-5, 5)
          .advanced(),
      parameter("scan_shift_y_mm", &MeasurementEffects::scan_shift_y_mm, "Scan off in y", unit::mm, -100, 100,
                "Measured less true.")
          .group(group_title)
          .slider(-5, 5)
          .advanced(),
      parameter("scan_shift_z_mm", &MeasurementEffects::scan_shift_z_mm, "Scan off in z", unit::mm, -100, 100,
                "Measured less true.")
          .group(group_title)
          .slider(-5, 5)
          .advanced()};
};

}  // namespace formwright
