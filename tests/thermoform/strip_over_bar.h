// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A strip drawn over a round bar. Along the arc that touches, the tension of what slides falls by exp(-mu angle)
// (Euler, Eytelwein).

namespace formwright {

struct StripOverBar {
  double wrap;           // radians from the top to where the strip leaves the bar
  double tension_ratio;  // at the top, to that of what hangs free
};

/// A strip of 120 mm with `columns` cells, clamped at its ends, over a bar of 20 mm radius. The clamps go down by 60 mm
/// beside the bar, `step_mm` at a time. `friction`: mu, 0 where it sticks. NaN where the simulation finds no step.
StripOverBar draw_over_bar(double friction, int columns, double step_mm);

}  // namespace formwright
