// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/fabrication_result.h"

#include <functional>

#include "fabrication/egv_writer.h"
#include "fabrication/gcode_writer.h"
#include "fabrication/ruida_writer.h"
#include "fabrication/toolpath_preview.h"
#include "job/model_input.h"

namespace formwright {

std::vector<OutputInfo> laser_job_outputs() {
  return {{"job.gcode", "text/x-gcode", "G-code",
           "For GRBL or Marlin, as the controller says; not written when the job does not fit.", true},
          {"toolpath.json", "application/json", "Tool path", "What moves where and when, for the preview.", true},
          {"job.egv", "application/x-egv", "EGV",
           "For K40 lasers with an M2 Nano board, which take their power from the dial.", false},
          {"job.rd", "application/octet-stream", "RD", "For Ruida controllers.", false},
          {"preview.svg", "image/svg+xml", "Preview", "The bed with what is worked and the travel between.", false}};
}

std::vector<ReportField> laser_report_fields() {
  return {{"seconds_estimated", "Time", "s", "of the whole job, as the controller's planner runs it"},
          {"cut_mm", "Worked", "mm", "with the beam on, all passes"},
          {"travel_mm", "Travel", "mm", "with the beam off"},
          {"bounds_mm", "Bounds", "mm", "of what is worked, on the bed: x0, y0, x1, y1; the beam's middle"},
          {"fits", "Fits", "", "the bed, and keeps out of the no-go zones"},
          {"misfits", "Misfits", "", "why it does not, in words"},
          {"layers", "Layers", "", "in the order in which they run: paths, length, seconds of work"},
          {"line_count", "Lines", "", "of the G-code"},
          {"notes", "Notes", "", "what to know, in words"}};
}

void report_toolpath(Json& report, const Toolpath& path, const std::vector<std::string>& misfits, int lines) {
  const ToolpathBounds bounds = work_bounds(path);
  report["seconds_estimated"] = path.seconds;
  report["cut_mm"] = path.length_mm(true);
  report["travel_mm"] = path.length_mm(false);
  report["bounds_mm"] = {bounds.x0_mm, bounds.y0_mm, bounds.x1_mm, bounds.y1_mm};
  report["fits"] = misfits.empty();
  report["misfits"] = misfits;
  report["line_count"] = lines;
}

void write_laser_result(OperationResult& result, const OperationCall& call, const std::vector<OutputInfo>& outputs,
                        LaserPlan& plan, const LaserMachineOptions& machine) {
  const Bytes gcode = write_laser_gcode(plan.path, machine);
  const auto add = [&](const std::string& name, bool for_machine, const std::function<Bytes()>& bytes) {
    if (!call.wants(name) || (for_machine && !plan.misfits.empty())) return;
    for (const OutputInfo& info : outputs)
      if (info.name == name) result.outputs.push_back(make_output(info, bytes()));
    call.context.check_cancelled();
  };
  add("job.gcode", true, [&] { return gcode; });
  add("job.egv", true, [&] { return write_egv(plan.path, machine); });
  add("job.rd", true, [&] { return write_ruida(plan.path, machine); });
  add("toolpath.json", false, [&] { return write_toolpath_json(plan.path, machine); });
  add("preview.svg", false, [&] { return write_toolpath_svg(plan.path, machine); });
  report_toolpath(result.report, plan.path, plan.misfits, line_count(gcode));
  Json layers = Json::array();
  for (const LayerSummary& layer : plan.layers)
    layers.push_back(
        {{"layer", layer.layer}, {"paths", layer.paths}, {"length_mm", layer.length_mm}, {"seconds", layer.seconds}});
  result.report["layers"] = layers;
  if (machine.controller == Controller::k40)
    plan.notes.push_back(
        "The board takes its power from the dial on the machine: the layers' powers are not in job.egv.");
  result.report["notes"] = plan.notes;
}

}  // namespace formwright
