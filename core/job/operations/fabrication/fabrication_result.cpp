// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/operations/fabrication/fabrication_result.h"

#include <functional>

#include "fabrication/writers/egv_writer.h"
#include "fabrication/writers/gcode_writer.h"
#include "fabrication/writers/ruida_writer.h"
#include "fabrication/toolpath/toolpath_preview.h"
#include "job/contract/model_input.h"

namespace formwright {

std::vector<OutputInfo> laser_job_outputs() {
  return {
      {"job.gcode", "text/x-gcode", "G-code",
       "The job as G-code for a GRBL or Marlin controller. Not written if the job does not fit the bed.", true},
      {"toolpath.json", "application/json", "Tool path", "All moves with their times, for the preview.", true},
      {"job.egv", "application/x-egv", "EGV",
       "The job for K40 lasers with an M2 Nano board. The power is set on the dial of the machine.", false},
      {"job.rd", "application/octet-stream", "RD", "The job for Ruida controllers.", false},
      {"preview.svg", "image/svg+xml", "Preview", "A drawing of the bed with all working and travel moves.", false}};
}

std::vector<ReportField> laser_report_fields() {
  return {{"seconds_estimated", "Time", "s",
           "Time that the machine needs for the whole job, computed as its controller plans it."},
          {"cut_mm", "Beam on", "mm", "Length of all moves with the beam on, over all passes."},
          {"travel_mm", "Travel", "mm", "Length of all moves with the beam off."},
          {"bounds_mm", "Bounds", "mm",
           "Rectangle on the bed that the centre of the beam works in: left, front, right, back."},
          {"fits", "Fits", "", "Whether the job fits the bed and keeps out of the no-go zones."},
          {"misfits", "Why it does not fit", "", "Why the job does not fit the bed or the no-go zones, as sentences."},
          {"layers", "Layers", "",
           "Every layer in the order in which it runs: number of paths, length, and seconds of work."},
          {"line_count", "Lines", "", "Number of lines of G-code."},
          {"notes", "Notes", "", "What to know about the result, as sentences."}};
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
    plan.notes.push_back("Set the power on the dial of the machine: job.egv cannot hold the power of each layer.");
  result.report["notes"] = plan.notes;
}

}  // namespace formwright
