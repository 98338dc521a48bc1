// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/test_grid.h"
#include "job/contract/operation_options.h"
#include "job/operations/fabrication/fabrication_operations.h"
#include "job/operations/fabrication/fabrication_result.h"
#include "job/contract/model_input.h"

namespace formwright {
namespace {

std::vector<OutputInfo> test_grid_outputs() {
  std::vector<OutputInfo> all = laser_job_outputs();
  all.push_back({"grid.svg", "image/svg+xml", "Drawing", "A drawing of the test.", false});
  return all;
}

OperationResult run_test_grid(const OperationCall& call, const TestGridOptions& options) {
  Stopwatch watch;
  const TestGrid grid = make_test_grid(options, call.context);
  LaserPlan plan = run_strokes({grid.labels, grid.strokes}, options, 0, true, call.context);
  OperationResult result;
  write_laser_result(result, call, test_grid_outputs(), plan, options);
  if (call.wants("grid.svg"))
    result.outputs.push_back(make_output(test_grid_outputs().back(), write_svg(grid.drawing)));
  Json cells = Json::array();
  for (const TestCell& cell : grid.cells)
    cells.push_back({{"name", cell.name},
                     {"power_percent", cell.power_percent},
                     {"speed_mm_per_s", cell.speed_mm_per_s},
                     {"z_mm", cell.z_mm},
                     {"x_mm", cell.x_mm},
                     {"y_mm", cell.y_mm}});
  result.report["cells"] = cells;
  result.report["seconds_plan"] = watch.seconds();
  result.report["peak_memory_mb"] = call.context.peak_memory_mb();
  return result;
}

}  // namespace

Operation test_grid_operation() {
  Operation operation;
  operation.name = "test-grid";
  operation.title = "Laser test";
  operation.summary =
      "Makes a test piece that shows which power and speed a material needs, how wide the beam burns, or where its focus is.";
  operation.outputs = test_grid_outputs();
  operation.report = laser_report_fields();
  operation.report.push_back(
      {"cells", "Cells", "", "Every square or line of the test with its power, speed, height and position."});
  operation.report.push_back({"seconds_plan", "Planning", "s", "Time for planning and writing the test."});
  operation.report.push_back(
      {"peak_memory_mb", "Peak memory", "MB", "Largest amount of memory that the process used."});
  take_options<TestGridOptions>(operation, run_test_grid,
                                [](const TestGridOptions& options) { read_no_go(options.no_go); });
  return operation;
}

}  // namespace formwright
