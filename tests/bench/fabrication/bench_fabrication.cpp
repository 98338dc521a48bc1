// SPDX-License-Identifier: GPL-3.0-or-later
// A laser's job from a drawing of 10,000 segments, and from one of 1,000 outlines; a mill's job from 2000 x 2000
// heights. JSON out.
#include <cmath>
#include <iostream>
#include <numbers>

#include "base/context.h"
#include "base/data/json.h"
#include "base/random.h"
#include "fabrication/writers/egv_writer.h"
#include "fabrication/writers/gcode_writer.h"
#include "fabrication/laser/laser_plan.h"
#include "fabrication/mill/mill_plan.h"
#include "fabrication/writers/ruida_writer.h"

namespace formwright {
namespace {

CutPath outline(Random& random, double x, double y, double radius, int corners) {
  CutPath path{CutLayer::cut, {}, true, ""};
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners, r = radius * random.uniform(0.7, 1);
    path.points_mm.emplace_back(x + r * std::cos(angle), y + r * std::sin(angle));
  }
  return path;
}

Json laser(int across, int corners, bool separate_lines) {
  Random random(1);
  CutSheet sheet{"bench", 600, 600, {}};
  const double cell = 600.0 / across;
  for (int i = 0; i < across * across; ++i) {
    const CutPath one = outline(random, cell * (i % across + 0.5), cell * (i / across + 0.5), 0.45 * cell, corners);
    for (std::size_t k = 0; k < one.points_mm.size() && separate_lines; ++k)
      sheet.paths.push_back({CutLayer::mark,
                             {one.points_mm[k], one.points_mm[k] + Vec2(random.uniform(-3, 3), random.uniform(-3, 3))},
                             false,
                             ""});
    if (!separate_lines) sheet.paths.push_back(one);
  }
  for (std::size_t i = sheet.paths.size(); i-- > 1;) std::swap(sheet.paths[i], sheet.paths[random.below(i + 1)]);
  const Bytes svg = write_svg(sheet);
  LaserOptions options;
  options.bed_x_mm = options.bed_y_mm = 620;
  options.x_mm = options.y_mm = 5;
  Context context;
  Stopwatch watch;
  const SvgDrawing drawing = read_svg_drawing(svg, {}, context);
  const double seconds_read = watch.lap();
  LaserPlan plan = plan_laser_job(drawing.sheet, options, context);
  const double seconds_plan = watch.lap();
  const Bytes gcode = write_laser_gcode(plan.path, options);
  const double seconds_gcode = watch.lap();
  const Bytes json = write_toolpath_json(plan.path, options);
  const double seconds_json = watch.lap();
  const Bytes egv = write_egv(plan.path, options);
  const double seconds_egv = watch.lap();
  const Bytes rd = write_ruida(plan.path, options);
  return {{"paths", sheet.paths.size()},
          {"segments", across * across * corners},
          {"lines", line_count(gcode)},
          {"fits", plan.misfits.empty()},
          {"job_seconds", plan.path.seconds},
          {"travel_mm", plan.path.length_mm(false)},
          {"work_mm", plan.path.length_mm(true)},
          {"seconds_read", seconds_read},
          {"seconds_plan", seconds_plan},
          {"seconds_gcode", seconds_gcode},
          {"seconds_toolpath_json", seconds_json},
          {"seconds_egv", seconds_egv},
          {"seconds_rd", watch.seconds()},
          {"bytes", {gcode.size(), json.size(), egv.size(), rd.size()}}};
}

Json mill(int nodes, ToolShape shape) {
  HeightField surface{nodes, nodes, 0.1, 0.1, {}};
  for (int r = 0; r < nodes; ++r)
    for (int c = 0; c < nodes; ++c) {
      const double x = 0.1 * c, y = 0.1 * r;
      surface.z_mm.push_back(static_cast<float>(-2.5 + 1.5 * std::sin(0.11 * x) * std::cos(0.13 * y) +
                                                0.5 * std::sin(0.9 * x + 0.4 * y) + 0.3 * std::sin(0.2 * x - 1.3 * y)));
    }
  MillOptions options;
  options.tool = shape;
  options.rough_diameter_mm = 6;
  options.bed_x_mm = options.bed_y_mm = 0.1 * nodes + 1;
  Context context;
  Stopwatch watch;
  MillPlan plan = plan_mill_job(surface, options, context);
  const double seconds_plan = watch.lap();
  std::vector<Bytes> jobs;
  for (std::size_t stage = 0; stage < std::max<std::size_t>(plan.path.stages.size(), 1); ++stage)
    jobs.push_back(write_mill_gcode(plan.path, options, 12'000, stage));
  int lines = 0;
  std::size_t gcode_bytes = 0;
  for (const Bytes& job : jobs) lines += line_count(job), gcode_bytes += job.size();
  const double seconds_gcode = watch.lap();
  const Bytes json = write_toolpath_json(plan.path, options);
  return {{"nodes", nodes},
          {"tool", EnumNames<ToolShape>::names[static_cast<std::size_t>(shape)]},
          {"layers", plan.layers},
          {"lines", lines},
          {"job_seconds", plan.path.seconds},
          {"deviation_mean_mm", plan.deviation.mean_mm},
          {"deviation_p95_mm", plan.deviation.p95_mm},
          {"deviation_max_mm", plan.deviation.max_mm},
          {"tool_mean_mm", plan.of_tool ? plan.of_tool->mean_mm : -1},
          {"tool_max_mm", plan.of_tool ? plan.of_tool->max_mm : -1},
          {"seconds_plan", seconds_plan},
          {"seconds_gcode", seconds_gcode},
          {"seconds_toolpath_json", watch.seconds()},
          {"bytes", {gcode_bytes, json.size()}}};
}

}  // namespace
}  // namespace formwright

int main() {
  using namespace formwright;
  const Json result = {
      {"laser_10k_segments_in_1024_outlines", laser(32, 10, false)},
      {"laser_10k_separate_lines", laser(32, 10, true)},
      {"mill_2000", {mill(2000, ToolShape::ball), mill(2000, ToolShape::v), mill(2000, ToolShape::flat)}}};
  std::cout << result.dump(2) << '\n';
}
