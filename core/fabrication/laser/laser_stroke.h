// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// One path of a drawing as the laser runs it: passes, tabs, overcut; and the order of many.
#include <string>
#include <vector>

#include "base/context.h"
#include "fabrication/toolpath/toolpath.h"

namespace formwright {

struct LaserStroke {
  std::string layer, part;
  std::vector<Vec2> points_mm;  // of the beam's middle, on the bed
  bool closed = false;
  double power_percent = 0, speed_mm_per_s = 1;
  int passes = 1;
  double z_mm = 0;               // of the first pass, over the material's surface
  double step_down_mm = 0;       // lower with every further pass
  int tabs = 0;                  // gaps of a closed path's last pass
  double tab_gap_mm = 0;         // of the beam's middle
  double overcut_mm = 0;         // of a closed path's last pass, past its start, up to the first gap
  int inside_of = -1;            // index of the stroke that must come after this one; -1: none
  bool fixed_direction = false;  // an open path that is run as given
};

struct StrokeRun {
  int stroke = 0;
  int first = 0;  // the point at which it begins; of an open path 0 or the last one
};

/// Everything once: a stroke's insides before itself and right before it, with as little travel between as short_route
/// finds. `free_start` off: closed paths begin at their first point.
std::vector<StrokeRun> order_strokes(const std::vector<LaserStroke>& strokes, const Vec2& start_mm, bool free_start,
                                     const Context& context);

/// Arc lengths at which the middles of `count` gaps go: evenly spread, each moved by at most a quarter of their
/// distance to keep `clear_mm` away from corners of over 15 degrees and from the start. Fewer when they would take over
/// half of the path.
std::vector<double> place_tabs(const std::vector<Vec2>& closed_mm, int count, double clear_mm);

/// All passes of one stroke. Passes of an open path run there and back.
void run_stroke(ToolpathBuilder& builder, const LaserStroke& stroke, int first);

}  // namespace formwright
