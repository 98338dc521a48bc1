// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstdio>

#include "job/contract/operation_options.h"
#include "job/operations/thermoform/thermoform_input.h"
#include "job/operations/thermoform/thermoform_operations.h"
#include "thermoform/sheet/sheet_lookup.h"

namespace formwright {
namespace {

std::vector<OutputInfo> thermoform_compare_outputs() {
  return {
      {"errors.ply", "application/x-ply", "Error map",
       "The simulated sheet with the error near every vertex; −1 where nothing was measured.", true},
      {"residuals.csv", "text/csv", "Residuals",
       "One line for each measured point: its simulated position and the distance to it.", true},
      {"sheet.ply", "application/x-ply", "Formed sheet", "The formed sheet as thermoform-simulate writes it.", false}};
}

std::vector<ReportField> thermoform_compare_report_fields() {
  return {
      {"points", "Measured points", "", "Number of measured points: rows of measured.csv."},
      {"error_mean_mm", "Mean error", "mm", "Mean distance between measured and simulated position over all points."},
      {"error_rms_mm", "RMS error", "mm", "Root mean square of the distances between measured and simulated position."},
      {"error_median_mm", "Median error", "mm",
       "Half of the measured points lie closer than this to their simulated position."},
      {"error_90_mm", "90 % of errors below", "mm",
       "90 % of the measured points lie closer than this to their simulated position."},
      {"error_95_mm", "95 % of errors below", "mm",
       "95 % of the measured points lie closer than this to their simulated position."},
      {"error_max_mm", "Largest error", "mm", "Largest distance between measured and simulated position of any point."},
      {"error_mean_without_outliers_mm", "Mean error without outliers", "mm",
       "Mean distance without points that lie more than 5 robust standard deviations above the median."},
      {"outliers", "Outliers", "",
       "Number of points that lie more than 5 robust standard deviations above the median distance."},
      {"error_along_normal_mean_mm", "Mean error along the normal", "mm",
       "Mean distance at right angles to the sheet; positive if the measured sheet lies outside the simulated one."},
      {"sigma_mean_mm", "Mean measuring uncertainty", "mm",
       "Mean standard deviation of the measured points, from the column sigma_mm of measured.csv."},
      {"measured_surface", "Measured surface", "",
       "Which surface of the sheet the points lie on: mid (middle) or outer."},
      {"triangles", "Triangles", "", "Number of triangles in the simulated sheet."},
      {"seconds_simulation", "Simulation", "s", "Time for the simulation; 0 if an earlier one was used again."},
      {"seconds_compare", "Comparison", "s", "Time for comparing all points."},
      {"peak_memory_mb", "Peak memory", "MB", "Largest amount of memory that the process used."},
      {"notes", "Notes", "", "What to know about the result, as sentences."}};
}

InputInfo measured_input_info() {
  InputInfo info;
  info.name = "measured";
  info.label = "Measured points";
  info.help = "The measured.csv of an object, with the columns sheet_x_mm, sheet_y_mm, x_mm, y_mm, z_mm and sigma_mm.";
  info.extensions = {"csv"};
  info.object_file = "measured.csv";
  return info;
}

/// The mean error of the points that fall on the faces around each vertex, weighted by nearness.
Bytes error_map(const FormedSheet& sheet, const std::vector<MeasuredPoint>& points, const Comparison& comparison,
                const MeasurementEffects& effects, Context& context) {
  const SheetLookup lookup(sheet);
  const Eigen::Index n = sheet.mesh.V.rows();
  Eigen::VectorXd error = Eigen::VectorXd::Zero(n), weight = Eigen::VectorXd::Zero(n);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto at = lookup.find(effects.on_sheet(points[i].sheet_mm));
    if (!at) continue;
    for (int k = 0; k < 3; ++k) {
      error[sheet.mesh.F(at->face, k)] += at->barycentric[k] * comparison.points[i].error_mm;
      weight[sheet.mesh.F(at->face, k)] += at->barycentric[k];
    }
  }
  for (Eigen::Index v = 0; v < n; ++v) error[v] = weight[v] > 1e-9 ? error[v] / weight[v] : -1;
  Model model;
  model.mesh = sheet.mesh;
  const std::vector<VertexColumn> columns = {{"error_mm", error, ColumnKind::float64},
                                             {"measured_weight", weight, ColumnKind::float64}};
  WriteOptions write;
  write.columns = columns;
  return write_model(model, MeshFormat::ply, write, context);
}

Bytes residuals(const std::vector<MeasuredPoint>& points, const Comparison& comparison) {
  std::string text = "sheet_x_mm,sheet_y_mm,x_mm,y_mm,z_mm,simulated_x_mm,simulated_y_mm,simulated_z_mm,error_mm\n";
  char line[256];
  for (std::size_t i = 0; i < points.size(); ++i) {
    const MeasuredPoint& p = points[i];
    const ComparedPoint& c = comparison.points[i];
    std::snprintf(line, sizeof line, "%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n", p.sheet_mm.x(), p.sheet_mm.y(),
                  p.place_mm.x(), p.place_mm.y(), p.place_mm.z(), c.simulated_mm.x(), c.simulated_mm.y(),
                  c.simulated_mm.z(), c.error_mm);
    text += line;
  }
  const ByteView view = as_bytes(text);
  return {view.begin(), view.end()};
}

OperationResult run_thermoform_compare(const OperationCall& call, const Json& given, const Json& given_measurement) {
  const SimulationCall simulation = simulation_call(call, given);
  Json measurement = given_measurement;
  if (const auto profile = machine_profile(call)) {
    measurement = write_parameters(profile->measurement);
    measurement.update(given_measurement);
  }
  const auto effects = read_parameters<MeasurementEffects>(measurement);
  const std::vector<MeasuredPoint> points = read_measured_points(*call.inputs.at("measured").bytes);
  std::vector<MeasuredPoint> in_clamp = points;
  if (simulation.setup->sheet_turned)
    for (MeasuredPoint& point : in_clamp) point.sheet_mm = -point.sheet_mm;
  Simulated simulated;
  {
    const auto span = call.context.span(0, 0.9, "Forming");
    simulated = simulate(call, simulation);
  }
  call.context.progress(0.9, "Comparing");
  Stopwatch watch;
  const ObjectSetup& setup = *simulation.setup;
  FormedSheet sheet = simulated.result->sheet;
  sheet.mesh.V.col(2).array() += setup.base_plate_end_z_mm;
  const Comparison comparison =
      compare(sheet, in_clamp, setup.measured_surface, simulation.options.clamp_height_mm + setup.base_plate_end_z_mm,
              simulation.options.sheet_thickness_mm, effects, setup.base_plate_end_z_mm, call.context);
  OperationResult result;
  Json& report = result.report;
  double sigma = 0;
  for (const MeasuredPoint& point : points) sigma += point.sigma_mm / static_cast<double>(points.size());
  report["points"] = points.size();
  report["error_mean_mm"] = comparison.mean_mm;
  report["error_rms_mm"] = comparison.root_mean_square_mm;
  report["error_median_mm"] = comparison.median_mm;
  report["error_90_mm"] = comparison.percentile_90_mm;
  report["error_95_mm"] = comparison.percentile_95_mm;
  report["error_max_mm"] = comparison.maximum_mm;
  report["error_mean_without_outliers_mm"] = comparison.mean_without_outliers_mm;
  report["outliers"] = comparison.outliers;
  report["error_along_normal_mean_mm"] = comparison.along_normal_mean_mm;
  report["sigma_mean_mm"] = sigma;
  report["measured_surface"] = setup.measured_surface == MeasuredSurface::outer ? "outer" : "mid";
  report["triangles"] = sheet.mesh.face_count();
  report["seconds_simulation"] = simulated.reused ? 0.0 : simulated.result->seconds;
  report["seconds_compare"] = watch.seconds();
  report["notes"] = setup.notes;
  const auto add = [&](const char* name, Bytes bytes) {
    for (const OutputInfo& info : thermoform_compare_outputs())
      if (info.name == name) result.outputs.push_back(make_output(info, std::move(bytes)));
  };
  if (call.wants("errors.ply")) add("errors.ply", error_map(sheet, in_clamp, comparison, effects, call.context));
  if (call.wants("residuals.csv")) add("residuals.csv", residuals(points, comparison));
  if (call.wants("sheet.ply")) add("sheet.ply", write_sheet_ply(sheet, 0, call.context));
  return result;
}

}  // namespace

Operation thermoform_compare_operation() {
  Operation operation;
  operation.name = "thermoform-compare";
  operation.title = "Compare with a measured object";
  operation.summary =
      "Simulates the set-up of a measured object and reports how far simulation and measurement differ.";
  InputInfo setup = setup_input_info();
  setup.required = true;
  operation.inputs = {mould_input_info(), setup, measured_input_info(), profile_input_info()};
  operation.outputs = thermoform_compare_outputs();
  operation.report = thermoform_compare_report_fields();
  take_mergeable_options<ThermoformOptions, MeasurementEffects>(operation, run_thermoform_compare);
  return operation;
}

}  // namespace formwright
