// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "fabrication/writers/gcode_writer.h"
#include "fabrication/laser/laser_plan.h"
#include "fabrication/toolpath/toolpath_preview.h"
#include "job/contract/operation_options.h"
#include "job/operations/fabrication/fabrication_operations.h"
#include "job/operations/fabrication/fabrication_result.h"
#include "job/contract/model_input.h"

namespace formwright {
namespace {

std::vector<InputInfo> laser_job_inputs() {
  InputInfo drawing;
  drawing.name = "drawing";
  drawing.label = "Drawing";
  drawing.help =
      "An SVG drawing with its size in mm. Layers are recognised by the names of groups (cut, mark, engrave, note) or by colour (red, blue, black, green).";
  drawing.extensions = {"svg"};
  return {drawing};
}

OperationResult run_laser_job(const OperationCall& call, const LaserOptions& options) {
  Context& context = call.context;
  Stopwatch watch;
  context.progress(0, "Reading the drawing");
  SvgReadOptions reading;
  reading.user_unit = options.user_unit;
  const SvgDrawing drawing = read_svg_drawing(*call.inputs.at("drawing").bytes, reading, context);
  const double seconds_read = watch.lap();
  LaserPlan plan;
  {
    const auto span = context.span(0.1, 0.9, "Planning");
    plan = plan_laser_job(drawing.sheet, options, context);
  }
  plan.notes.insert(plan.notes.begin(), drawing.notes.begin(), drawing.notes.end());
  const double seconds_plan = watch.lap();
  context.progress(0.9, "Writing");
  OperationResult result;
  write_laser_result(result, call, laser_job_outputs(), plan, options);
  result.report["drawing_mm"] = {drawing.sheet.width_mm, drawing.sheet.height_mm};
  result.report["kerf_mm"] = options.kerf_mm;
  result.report["seconds_read"] = seconds_read;
  result.report["seconds_plan"] = seconds_plan;
  result.report["seconds_write"] = watch.seconds();
  result.report["peak_memory_mb"] = context.peak_memory_mb();
  return result;
}

}  // namespace

Operation laser_job_operation() {
  Operation operation;
  operation.name = "laser-job";
  operation.title = "Laser job";
  operation.summary =
      "Turns a drawing into a job for a laser cutter, with kerf, cutting order, tabs, power, speed and an estimate of the time.";
  operation.inputs = laser_job_inputs();
  operation.outputs = laser_job_outputs();
  operation.report = laser_report_fields();
  operation.report.push_back({"drawing_mm", "Drawing", "mm", "Width and height of the drawing as read."});
  operation.report.push_back(
      {"kerf_mm", "Kerf", "mm", "Width that the beam removes; parts were enlarged by half of it."});
  operation.report.push_back({"seconds_read", "Reading", "s", "Time for reading the drawing."});
  operation.report.push_back({"seconds_plan", "Planning", "s", "Time for kerf, order and time of the paths."});
  operation.report.push_back({"seconds_write", "Writing", "s", "Time for writing the output files."});
  operation.report.push_back(
      {"peak_memory_mb", "Peak memory", "MB", "Largest amount of memory that the process used."});
  take_options<LaserOptions>(operation, run_laser_job, [](const LaserOptions& options) { read_no_go(options.no_go); });
  return operation;
}

}  // namespace formwright
