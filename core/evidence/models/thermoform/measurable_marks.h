// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Marks on a sheet that can be drawn with a ruler before it is formed, and reached with calipers afterwards.
#include "evidence/models/thermoform/thermoform_model.h"

namespace formwright {

struct MarkOptions {
  double spacing_mm = 10;  // of the grid that marks lie on, from the sheet's centre
  double sigma_mm = 0.3;   // standard deviation of each measured coordinate
};

struct MeasurableMarks {
  std::vector<MeasuredPoint>
      points;             // row by row from the front; place_mm: where each is expected, machine coordinates
  double spacing_mm = 0;  // as asked for, or twice, four times ... that where there would be too many
};

/// Marks within the clamp opening that are seen from above on the formed sheet, where it leans by at most 75 degrees:
/// steeper, a mark can hardly be read, and a depth gauge slides down. `object.points` is not looked at. Throws
/// Error{invalid_input, "spacing_mm"} where fewer than four are left, Error{could_not_solve, cancelled}.
MeasurableMarks measurable_marks(const FormedObject& object, const ThermoformModelOptions& model,
                                 const MarkOptions& options, Context& context);

}  // namespace formwright
