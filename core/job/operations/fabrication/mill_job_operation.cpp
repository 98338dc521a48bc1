// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "fabrication/writers/gcode_writer.h"
#include "fabrication/mill/mill_plan.h"
#include "fabrication/mill/mill_presets.h"
#include "fabrication/toolpath/toolpath_preview.h"
#include "formats/mesh_io.h"
#include "formats/png/png16.h"
#include "job/contract/operation_options.h"
#include "job/operations/fabrication/fabrication_operations.h"
#include "job/operations/fabrication/fabrication_result.h"
#include "job/contract/model_input.h"
#include "relief/height_map.h"

namespace formwright {
namespace {

constexpr double max_nodes = 16e6;
constexpr const char* gcode_media_type = "text/x-gcode";

std::vector<InputInfo> mill_job_inputs() {
  InputInfo model = model_input_info();
  model.name = "model";
  model.help = "A model, carved as seen from above (z up), or a height map as PNG, in which white is high.";
  model.extensions.emplace_back("png");
  return {model};
}

std::vector<OutputInfo> mill_job_outputs() {
  return {
      {"job.gcode", gcode_media_type, "G-code",
       "The job as G-code for GRBL or Marlin, if one tool does everything. Not written if the job does not fit the bed.",
       true},
      {"job_1_rough.gcode", gcode_media_type, "G-code, roughing",
       "The first of two jobs if the roughing and finishing tools differ: roughing.", true},
      {"job_2_finish.gcode", gcode_media_type, "G-code, finishing",
       "The second of two jobs if the roughing and finishing tools differ: finishing. Set z to 0 again with the new tool before it.",
       true},
      {"toolpath.json", "application/json", "Tool path", "All moves with their times, for the preview.", true},
      {"carved.ply", "model/ply", "Carved surface", "The carving as the tool leaves it, as a solid.", true},
      {"preview.svg", "image/svg+xml", "Preview", "A drawing of the bed with all working and travel moves.", false}};
}

bool is_png(const InputBlob& input) {
  return input.bytes && input.bytes->size() > 8 && as_text(*input.bytes).substr(1, 3) == "PNG";
}

/// Heights over the lowest place; z over the stock comes later.
HeightMap height_map_of(const OperationCall& call, const MillOptions& options) {
  const InputBlob& input = call.inputs.at("model");
  HeightMap map;
  if (is_png(input)) {
    const Grey16Image image = read_png16(*input.bytes, input.file_name, "model");
    const double width = options.width_mm ? *options.width_mm : image.pixel_width_mm * (image.width - 1);
    if (width <= 0)
      throw Error(ErrorCode::invalid_input, "width_mm", "The height map does not contain its size: give its width.");
    if (image.width < 2 || image.height < 2)
      throw Error(ErrorCode::invalid_input, "model",
                  "The height map is a single row of pixels: choose another picture.");
    map.columns = image.width;
    map.rows = image.height;
    map.pitch_x_mm = width / (image.width - 1);
    map.pitch_y_mm = image.pixel_width_mm > 0 && image.pixel_height_mm > 0
                         ? map.pitch_x_mm * image.pixel_height_mm / image.pixel_width_mm
                         : map.pitch_x_mm;
    map.height_mm.resize(image.levels.size());
    for (int r = 0; r < map.rows; ++r)
      for (int c = 0; c < map.columns; ++c)
        map.at(r, c) = static_cast<float>(
            options.thickness_mm *
            image.levels[static_cast<std::size_t>(map.rows - 1 - r) * static_cast<std::size_t>(map.columns) +
                         static_cast<std::size_t>(c)] /
            65535);
  } else {
    const auto loaded = load_model(call, "model");
    const TriangleMesh& mesh = loaded->model.mesh;
    if (mesh.V.rows() == 0) throw Error(ErrorCode::invalid_input, "model", "The model is empty.");
    const Eigen::RowVector3d low = mesh.V.colwise().minCoeff(), high = mesh.V.colwise().maxCoeff();
    const Eigen::RowVector3d size = high - low;
    if (size.x() <= 0 || size.y() <= 0)
      throw Error(ErrorCode::invalid_input, "model",
                  "The model has no extent seen from above: turn it so that z is up.");
    const double scale = options.width_mm ? *options.width_mm / size.x() : 1;
    Positions moved(mesh.V.rows(), 3);
    moved.col(0) = mesh.V.col(0).array() - (low.x() + high.x()) / 2;
    moved.col(1) = mesh.V.col(1).array() - (low.y() + high.y()) / 2;
    moved.col(2) = low.z() - mesh.V.col(2).array();
    if (scale * scale * size.x() * size.y() > max_nodes * options.pixel_mm * options.pixel_mm)
      throw Error(ErrorCode::invalid_input, "pixel_mm",
                  "The grid would have over 16 million points: raise the grid spacing or lower the width.");
    map = make_height_map(moved, mesh.F, scale, {scale * size.x(), scale * size.y()}, options.pixel_mm,
                          scale * size.z(), call.context);
  }
  if (static_cast<double>(map.columns) * map.rows > max_nodes)
    throw Error(ErrorCode::invalid_input, "model", "The height map has over 16 million pixels: make it smaller.");
  return map;
}

void report_deviation(Json& report, const std::string& name, const Deviation& deviation) {
  report[name + "_mean_mm"] = deviation.mean_mm;
  report[name + "_p95_mm"] = deviation.p95_mm;
  report[name + "_max_mm"] = deviation.max_mm;
}

OperationResult run_mill_job(const OperationCall& call, const MillOptions& options) {
  Context& context = call.context;
  Stopwatch watch;
  context.progress(0, "Reading the model");
  HeightMap map = height_map_of(call, options);
  const float top = *std::max_element(map.height_mm.begin(), map.height_mm.end()),
              bottom = *std::min_element(map.height_mm.begin(), map.height_mm.end());
  HeightField surface{map.columns, map.rows, map.pitch_x_mm, map.pitch_y_mm, map.height_mm};
  for (float& z : surface.z_mm) z -= top + static_cast<float>(options.stock_over_mm);
  const double seconds_read = watch.lap();
  MillPlan plan;
  {
    const auto span = context.span(0.1, 0.9, "Planning");
    plan = plan_mill_job(surface, options, context);
  }
  const double seconds_plan = watch.lap();
  context.progress(0.9, "Writing");
  OperationResult result;
  std::vector<ToolpathStage> jobs = plan.path.stages;
  if (jobs.empty()) jobs.push_back({"", "job.gcode"});
  // Whoever asks for the job gets all of it, in whatever files it comes.
  bool wants_job = false;
  for (const OutputInfo& info : mill_job_outputs())
    wants_job = wants_job || (info.media_type == gcode_media_type && call.wants(info.name));
  Json stages = Json::array();
  int lines = 0;
  for (std::size_t stage = 0; stage < jobs.size(); ++stage) {
    const Bytes gcode = write_mill_gcode(plan.path, options, options.spindle_rpm, stage);
    lines += line_count(gcode);
    if (!plan.path.stages.empty())
      stages.push_back({{"stage", jobs[stage].name}, {"file", jobs[stage].file}, {"lines", line_count(gcode)}});
    if (!wants_job || !plan.misfits.empty()) continue;
    for (const OutputInfo& info : mill_job_outputs())
      if (info.name == jobs[stage].file) result.outputs.push_back(make_output(info, gcode));
  }
  const auto add = [&](const char* name, auto&& bytes) {
    if (!call.wants(name)) return;
    for (const OutputInfo& info : mill_job_outputs())
      if (info.name == name) result.outputs.push_back(make_output(info, bytes()));
  };
  add("toolpath.json", [&] { return write_toolpath_json(plan.path, options); });
  add("preview.svg", [&] { return write_toolpath_svg(plan.path, options); });
  add("carved.ply", [&] {
    // On a plate of 2 mm, so that it is a solid wherever the carving goes down to.
    for (std::size_t i = 0; i < map.height_mm.size(); ++i)
      map.height_mm[i] = plan.carved.z_mm[i] + top + static_cast<float>(options.stock_over_mm) - bottom;
    Model model;
    model.mesh = make_solid(map, 2, 0.01, context);
    return write_model(model, MeshFormat::ply, context);
  });
  Json& report = result.report;
  report_toolpath(report, plan.path, plan.misfits, lines);
  report["stages"] = stages;
  report["seconds_rough"] = plan.rough_seconds;
  report["seconds_finish"] = plan.finish_seconds;
  report["size_mm"] = {map.width_mm(), map.depth_mm(), static_cast<double>(top - bottom)};
  report["grid_mm"] = {map.pitch_x_mm, map.pitch_y_mm};
  report["layers"] = plan.layers;
  report["finish_stepover_mm"] = plan.finish_stepover_mm;
  if (options.tool == ToolShape::ball && options.stages != MillStages::rough)
    report["scallop_mm"] = scallop_mm(options.diameter_mm, plan.finish_stepover_mm);
  report_deviation(report, "deviation", plan.deviation);
  if (plan.of_tool && options.stages != MillStages::rough) report_deviation(report, "tool_deviation", *plan.of_tool);
  report["seconds_read"] = seconds_read;
  report["seconds_plan"] = seconds_plan;
  report["seconds_write"] = watch.seconds();
  report["peak_memory_mb"] = context.peak_memory_mb();
  report["notes"] = plan.notes;
  return result;
}

std::vector<ReportField> mill_job_report_fields() {
  std::vector<ReportField> fields = laser_report_fields();
  const auto rename = [&](const std::string& name, const std::string& label, const std::string& help) {
    for (ReportField& field : fields)
      if (field.name == name) field = {name, label, field.unit, help};
  };
  rename("cut_mm", "Tool engaged", "Length of all moves with the tool in the material or on its surface.");
  rename("travel_mm", "Travel", "Length of all rapid moves above the stock.");
  rename("bounds_mm", "Bounds", "Rectangle on the bed that the tool's axis moves in: left, front, right, back.");
  rename("layers", "Layers", "Number of roughing layers.");
  const std::vector<ReportField> more = {
      {"stages", "Jobs", "",
       "The jobs in the order in which they run, with a tool change between them: stage, file and lines."},
      {"seconds_rough", "Roughing", "s", "Time that the machine needs for roughing, without travel."},
      {"seconds_finish", "Finishing", "s", "Time that the machine needs for finishing, without travel."},
      {"size_mm", "Size", "mm", "Width, height and depth of the carving."},
      {"grid_mm", "Grid spacing", "mm", "Distance between the heights that the carving is computed from, in x and y."},
      {"finish_stepover_mm", "Stepover", "mm", "Distance between finishing lines after rounding to the grid."},
      {"scallop_mm", "Ridge height", "mm",
       "Height of the ridges that a ball tool leaves between two lines on a flat surface."},
      {"deviation_mean_mm", "Mean deviation", "mm", "Mean height of the simulated carving above the wanted surface."},
      {"deviation_p95_mm", "95 % deviation", "mm",
       "95 % of the simulated carving lie closer than this to the wanted surface."},
      {"deviation_max_mm", "Largest deviation", "mm",
       "Largest height of the simulated carving above the wanted surface: the deepest place that the tool cannot reach."},
      {"tool_deviation_mean_mm", "Mean lost to the round tool", "mm",
       "Mean height that the tool's shape alone leaves in hollows, even with the closest lines."},
      {"tool_deviation_p95_mm", "95 % lost to the round tool", "mm",
       "Height that the tool's shape alone leaves in hollows; 95 % of the surface has less."},
      {"tool_deviation_max_mm", "Largest lost to the round tool", "mm",
       "Largest height that the tool's shape alone leaves in a hollow."},
      {"seconds_read", "Reading", "s", "Time for reading the model and computing its heights."},
      {"seconds_plan", "Planning", "s", "Time for planning the lines and simulating the carving."},
      {"seconds_write", "Writing", "s", "Time for writing the output files."},
      {"peak_memory_mb", "Peak memory", "MB", "Largest amount of memory that the process used."}};
  fields.insert(fields.end(), more.begin(), more.end());
  return fields;
}

}  // namespace

Operation mill_job_operation() {
  Operation operation;
  operation.name = "mill-job";
  operation.title = "Mill job";
  operation.summary = "Makes the job that mills a relief or a height map, and reports where the tool cannot reach.";
  operation.inputs = mill_job_inputs();
  operation.outputs = mill_job_outputs();
  operation.report = mill_job_report_fields();
  operation.presets = {mill_material_presets()};
  take_options<MillOptions>(operation, run_mill_job, [](const MillOptions& options) { read_no_go(options.no_go); });
  return operation;
}

}  // namespace formwright
