// SPDX-License-Identifier: GPL-3.0-or-later
// A strip drawn over a round bar. Along the arc that touches, the tension of what slides falls by exp(-mu angle)
// (Euler, Eytelwein). Prints by how much the simulated tension at the top of the bar is off, as a table for
// docs/thermoform.md.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "thermoform/strip_over_bar.h"

int main() {
  using namespace formwright;
  std::printf("| mu | cells of 6 mm | of 3 mm | of 1.5 mm |\n|---|---|---|---|\n");
  for (const double friction : {0.05, 0.1, 0.25, 0.5}) {
    std::printf("| %g |", friction);
    for (const int columns : {20, 40, 80}) {
      double least = INFINITY, most = -INFINITY;
      int failed = 0;
      for (const double step_mm : {1.0, 0.5, 0.25, 0.125}) {
        const StripOverBar drawn = draw_over_bar(friction, columns, step_mm);
        const double off_percent = 100 * (drawn.tension_ratio / std::exp(-friction * drawn.wrap) - 1);
        if (!std::isfinite(off_percent)) ++failed;
        least = std::min(least, off_percent);
        most = std::max(most, off_percent);
      }
      std::printf(" %+.0f to %+.0f %%", least, most);
      if (failed > 0) std::printf(", %d of 4 not solved", failed);
      std::printf(" |");
    }
    std::printf("\n");
  }
}
