// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// From a drawing to a laser's job.
#include "fabrication/laser/laser_options.h"
#include "fabrication/laser/laser_stroke.h"

namespace formwright {

struct LayerSummary {
  std::string layer;
  int paths = 0;         // as run, passes not counted
  double length_mm = 0;  // with all passes
  double seconds = 0;    // of work, without travel
};

struct LaserPlan {
  Toolpath path;                     // begins and ends at the controller's origin
  std::vector<LayerSummary> layers;  // in the order in which they run
  std::vector<std::string> misfits;  // empty: the job fits the bed
  std::vector<std::string> notes;
};

/// Engraving, then marking, then cutting, notes never; kerf, order, tabs and passes as the options say.
/// Throws Error: invalid_input ("drawing": no path on an enabled layer; "engrave_line_mm"; "no_go"), cancelled.
LaserPlan plan_laser_job(const CutSheet& sheet, const LaserOptions& options, Context& context);

/// Strokes that are ready to run, in the order given by layer, into a plan with times and misfits.
LaserPlan run_strokes(const std::vector<std::vector<LaserStroke>>& layers, const LaserMachineOptions& machine,
                      double kerf_mm, bool free_start, Context& context);

}  // namespace formwright
