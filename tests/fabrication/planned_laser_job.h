// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Plans a laser's job on a page of 200 x 150 mm, and looks at what it works.
#include <string>
#include <utility>
#include <vector>

#include "fabrication/laser/laser_plan.h"
#include "fabrication/sheet/contours.h"

namespace formwright::test {

inline CutPath box(double x, double y, double width, double height, const std::string& name = "",
                   CutLayer layer = CutLayer::cut) {
  return {layer, {{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}}, true, name};
}

inline LaserPlan planned(std::vector<CutPath> paths, const LaserOptions& options) {
  Context context;
  return plan_laser_job({"t", 200, 150, std::move(paths)}, options, context);
}

inline std::vector<const ToolMove*> work_of(const LaserPlan& plan) {
  std::vector<const ToolMove*> work;
  for (const ToolMove& move : plan.path.moves)
    if (move.work) work.push_back(&move);
  return work;
}

inline double area_of(const ToolMove& move) {
  Polygon polygon;
  for (const Vec3& p : move.points_mm) polygon.push_back(p.head<2>());
  return signed_area_mm2(polygon);
}

}  // namespace formwright::test
