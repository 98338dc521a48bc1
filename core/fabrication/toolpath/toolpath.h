// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a machine does, move by move, and when: the same data for the preview, the estimate and every file format.
#include <string>
#include <utility>
#include <vector>

#include "base/bytes.h"
#include "fabrication/toolpath/machine_options.h"

namespace formwright {

/// One travel, or one run of the tool along a path; it begins where the move before ended. Coordinates in mm from the
/// bed's lower left corner, y up, z 0 at the material's surface, all of them whole micrometres: what is written with
/// three decimals is exact.
struct ToolMove {
  bool work = false;
  std::string layer;  // "cut", "mark", "engrave", "rough", "finish"; "" for travel
  std::string part;   // letters, digits and -; may be empty
  int pass = 1;
  double power_percent = 0, speed_mm_per_s = 0;
  std::vector<Vec3> points_mm;  // at least two
  std::vector<double> times_s;  // per point, from the job's start (time_moves)
  std::vector<int> lines;       // per point, of the job's G-code, from 1 (write_gcode)
};

/// A part of the path that is a job of its own, because the tool is changed before it.
struct ToolpathStage {
  std::string name;            // "rough", "finish"
  std::string file;            // name of its job
  std::size_t first_move = 0;  // up to the next stage's
  double start_s = 0;
};

struct Toolpath {
  std::vector<ToolMove> moves;
  double seconds = 0;
  std::vector<ToolpathStage> stages;  // empty: all of it is one job

  double length_mm(bool work) const;
};

/// Puts moves in a row: travels are added where one ends and the next does not begin; points are rounded to
/// micrometres, repeated ones left out.
class ToolpathBuilder {
 public:
  ToolpathBuilder(const Vec3& start_mm, double travel_speed_mm_per_s)
      : at_(start_mm), travel_speed_mm_per_s_(travel_speed_mm_per_s) {}

  void travel_to(const Vec3& p);
  /// Along all of the points without the tool working.
  void travel_along(const std::vector<Vec3>& points_mm);
  /// Travels to the first of `move.points_mm` and works along the others; what is shorter than a micrometre is left
  /// out.
  void work(ToolMove move);

  const Vec3& at() const { return at_; }
  Toolpath take() { return std::move(path_); }

 private:
  Vec3 at_;
  double travel_speed_mm_per_s_;
  Toolpath path_;
};

/// What the estimate needs to know of a controller.
struct MotionLimits {
  double acceleration_mm_per_s2 = 500, junction_deviation_mm = 0.01;
  int planner_blocks =
      16;  // of the controller; moves beyond them are not seen, and it must be able to stop before them
};

/// The paths in sequence; times continue. Needs at least one part, none with stages.
Toolpath in_stages(std::vector<std::pair<ToolpathStage, Toolpath>> parts);

/// Fills times_s and seconds as GRBL's planner runs the moves: trapezoids of speed at constant acceleration; in a
/// corner the speed whose centripetal acceleration on a circle that leaves the corner by the junction deviation is the
/// acceleration (Jeon 2009; grbl 1.1, planner.c); at rest at both ends.
void time_moves(Toolpath& path, const MotionLimits& limits);

/// Sentences for everything that touches a no-go zone, the tool being `width_mm` wide where it works, or leaves the
/// bed, by `edge_width_mm` (a beam burns over the edge; of a mill the axis must stay within the machine's reach).
/// Empty: it fits.
std::vector<std::string> find_misfits(const Toolpath& path, const MachineOptions& machine, double width_mm,
                                      double edge_width_mm);

struct ToolpathBounds {
  double x0_mm = 0, y0_mm = 0, x1_mm = 0, y1_mm = 0;
};
/// Of what the tool works on; of all zeros when it never does.
ToolpathBounds work_bounds(const Toolpath& path);

/// The job as the preview reads it: toolpath.json, one line; docs/fabrication.md says what it holds.
Bytes write_toolpath_json(const Toolpath& path, const MachineOptions& machine);

}  // namespace formwright
