// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "evidence/registration/scan_registration.h"
#include "geometry/io/mesh_io.h"
#include "imaging/png_writer.h"
#include "job/evidence_registration_operations.h"
#include "job/model_input.h"
#include "thermoform/measured_object.h"

namespace formwright {
namespace {

std::vector<InputInfo> inputs() {
  InputInfo scan = model_input_info();
  scan.name = "scan";
  scan.label = "Scan";
  scan.help = "The formed sheet with its picture: GLB, OBJ with texture, or PLY with colours.";
  scan.accepts_sample = false;
  return {
      scan,
      {"pattern", "Pattern", "pattern.json as evidence-pattern wrote it beside the print.", {"json"}, true, false, ""},
      {"material", "Material file", "The MTL file of an OBJ.", {"mtl"}, false, false, ""},
      {"texture",
       "Picture",
       "A PNG or JPEG, laid by the scan's texture coordinates in place of its own.",
       {"png", "jpg", "jpeg"},
       false,
       false,
       ""}};
}

std::vector<OutputInfo> outputs() {
  return {{"measured.csv", "text/csv", "Measured points",
           "Where each point of the flat sheet went, and how sure that is: docs/measured_data.md.", true},
          {"aligned.png", "image/png", "Scan on the sheet",
           "The scan's colours carried back to the flat sheet; it should look like the pattern.", true},
          {"flow.png", "image/png", "Displacement",
           "What was found beyond the four corners: hue is the direction, colour the length.", true}};
}

std::vector<ReportField> report_fields() {
  return {
      {"points", "Measured points", "", "rows of measured.csv"},
      {"points_without_evidence", "Points left out", "", "not seen, without noise to see, or too uncertain"},
      {"sigma_median_mm", "Uncertainty", "mm", "median of the points' standard deviation along the surface"},
      {"sigma_95_mm", "95 % of uncertainties below", "mm", "percentile"},
      {"coordinates", "Coordinates", "", "rim: the machine's; scan: the scanner's"},
      {"rim_rms_mm", "Rim", "mm",
       "root mean square distance of the scanned rim from where the machine holds it; null without a rim"},
      {"rim_scale", "Scale of the rim", "", "length on the sheet against length scanned; null without a rim"},
      {"corner_likeness", "Likeness of the marks", "",
       "correlation of each corner mark; 0 where it was not found or given by hand"},
      {"corner_px", "Corners in the picture", "px",
       "x and y of each corner mark in the scan's picture from its top left; null where the picture does not show it"},
      {"corner_residual_mm", "Corner residuals", "mm",
       "from each mark as found to where the registration has it; -1 where not known"},
      {"colour_rms_levels", "Colour fit", "", "grey levels left over of the mean colours after correction"},
      {"colour_error_levels", "Colour error", "",
       "root mean square of the flow's residual over all pixels, in grey levels"},
      {"likeness", "Likeness", "", "correlation of scan and pattern once matched, at most 1"},
      {"blur_px", "Blur", "px", "by which the scan is less sharp than the print, in compared pixels"},
      {"pixel_mm", "Compared pixel", "mm", "side on the sheet"},
      {"displacement_first_mm", "Beyond the corners", "mm", "root mean square displacement that the first flow found"},
      {"displacement_last_mm", "Last correction", "mm", "root mean square of the last flow"},
      {"flow_full_colour_mm", "Full colour", "mm", "length of the fullest colour of flow.png"},
      {"flattening_stretch_rms", "Flattening", "", "root mean square stretch of the flat scan, 0 is none"},
      {"flattening_flipped", "Faces upside down", "", "of the flat scan"},
      {"plane_scale", "Scale by the corners", "", "length on the sheet against length of the flat scan"},
      {"scan_faces", "Faces", "", "of the scan"},
      {"other_parts", "Other parts", "", "of the scan, left out"},
      {"holes", "Holes", "", "in the sheet's scan"},
      {"seconds_read", "Reading", "s", "scan and picture"},
      {"seconds_flatten", "Flattening", "s", ""},
      {"seconds_marks", "Marks", "s", ""},
      {"seconds_draw", "Drawing", "s", "scan and pattern in the sheet's frame"},
      {"seconds_flow", "Flow", "s", "three sizes together"},
      {"seconds_points", "Points", "s", "evidence, points, pictures of the result"},
      {"peak_memory_mb", "Peak memory", "MB", "of the process"},
      {"notes", "Notes", "", "in words"}};
}

/// The scan with its material file and its picture as given.
Model with_pictures(const OperationCall& call, const LoadedModel& loaded) {
  ModelFile file;
  file.model = loaded.model;
  if (const auto given = call.inputs.find("material"); given != call.inputs.end()) {
    // A reader keeps no trace of the library's name, so that any file will do.
    file.material_libraries = {"given.mtl"};
    const Companion library{"given.mtl", *given->second.bytes};
    ReadOptions options;
    options.where = "material";
    read_model_materials(file, {&library, 1}, options);
  }
  Model& model = file.model;
  if (const auto given = call.inputs.find("texture"); given != call.inputs.end()) {
    if (model.FT.rows() == 0)
      throw Error(ErrorCode::invalid_input, "texture",
                  "The scan has no texture coordinates to lay the picture by: export it with its UV map.");
    const Texture texture{given->second.file_name, "", *given->second.bytes};
    model.textures.assign(1, texture);
    model.materials.clear();
    model.face_material.clear();
  }
  bool has_picture = model.vertex_colours.rows() > 0;
  for (const Texture& texture : model.textures) has_picture = has_picture || !texture.bytes.empty();
  if (!has_picture)
    throw Error(ErrorCode::invalid_input, "texture",
                "The scan came without its picture: give the PNG or JPEG beside it, or a GLB that holds it.");
  return std::move(model);
}

Bytes measured_csv(const std::vector<RegisteredPoint>& registered) {
  std::vector<MeasuredPoint> points;
  for (const RegisteredPoint& p : registered) points.push_back({p.sheet_mm, p.place_mm, p.sigma_mm});
  return to_bytes(write_measured_points(points));
}

void report_registration(Json& report, const ScanRegistration& r, const CalibrationPattern& pattern,
                         const ScanRegistrationOptions& options) {
  std::vector<double> sigma;
  for (const RegisteredPoint& p : r.points) sigma.push_back(p.sigma_mm);
  std::sort(sigma.begin(), sigma.end());
  report["points"] = r.points.size();
  report["points_without_evidence"] = r.points_without_evidence;
  report["sigma_median_mm"] = sigma[sigma.size() / 2];
  report["sigma_95_mm"] = sigma[sigma.size() * 95 / 100];
  report["coordinates"] = r.in_machine_coordinates ? "rim" : "scan";
  report["rim_rms_mm"] = r.rim_rms_mm ? Json(*r.rim_rms_mm) : Json(nullptr);
  report["rim_scale"] = r.rim_scale ? Json(*r.rim_scale) : Json(nullptr);
  report["corner_likeness"] = r.marks.likeness;
  report["corner_px"] = Json::array();
  for (const std::optional<Vec2>& px : r.corner_px)
    report["corner_px"].push_back(px ? Json{px->x(), px->y()} : Json(nullptr));
  report["corner_residual_mm"] = r.corner_residual_mm;
  report["colour_rms_levels"] = r.colours.rms_levels;
  report["colour_error_levels"] = r.colour_error_levels;
  report["likeness"] = r.likeness;
  report["blur_px"] = r.blur_px;
  report["pixel_mm"] = pattern.sheet_mm.maxCoeff() / options.picture_px;
  report["displacement_first_mm"] = r.first_displacement_rms_mm;
  report["displacement_last_mm"] = r.last_displacement_rms_mm;
  report["flow_full_colour_mm"] = r.displacement_full_mm;
  report["flattening_stretch_rms"] = r.flat.stretch_rms;
  report["flattening_flipped"] = r.flat.flipped;
  report["plane_scale"] = r.plane_scale;
  report["scan_faces"] = r.scan_faces;
  report["other_parts"] = r.other_parts;
  report["holes"] = r.holes;
  report["seconds_flatten"] = r.seconds_flatten;
  report["seconds_marks"] = r.seconds_marks;
  report["seconds_draw"] = r.seconds_draw;
  report["seconds_flow"] = r.seconds_flow;
  report["seconds_points"] = r.seconds_points;
}

OperationResult run_register(const OperationCall& call) {
  const auto options = read_parameters<ScanRegistrationOptions>(call.parameters);
  Context& context = call.context;
  Stopwatch watch;
  const CalibrationPattern pattern = read_calibration_pattern(*call.inputs.at("pattern").bytes);
  OperationResult result;
  Json& report = result.report;
  ScanRegistration registration;
  {
    std::shared_ptr<const LoadedModel> loaded;
    {
      const auto span = context.span(0, 0.1, "Reading the scan");
      loaded = load_model(call, "scan");
    }
    const Model scan = with_pictures(call, *loaded);
    report["seconds_read"] = watch.lap();
    const auto span = context.span(0.1, 0.95, "Registering");
    registration = register_scan(scan, pattern, options, context);
    std::vector<std::string> notes = loaded->repairs;
    registration.notes.insert(registration.notes.begin(), notes.begin(), notes.end());
  }
  report_registration(report, registration, pattern, options);
  report["notes"] = registration.notes;
  context.progress(0.96, "Writing");
  const auto add = [&](const char* name, const auto& bytes) {
    if (!call.wants(name)) return;
    for (const OutputInfo& info : outputs())
      if (info.name == name) result.outputs.push_back(make_output(info, bytes()));
    context.check_cancelled();
  };
  const int per_metre = static_cast<int>(std::lround(1000 * options.picture_px / pattern.sheet_mm.maxCoeff()));
  add("measured.csv", [&] { return measured_csv(registration.points); });
  add("aligned.png", [&] { return write_png(registration.aligned, per_metre, context); });
  add("flow.png", [&] { return write_png(registration.displacement, 0, context); });
  report["peak_memory_mb"] = context.peak_memory_mb();
  return result;
}

}  // namespace

Operation evidence_register_operation() {
  Operation operation;
  operation.name = "evidence-register";
  operation.title = "Measure a scan";
  operation.summary =
      "Finds where every point of a printed sheet went, from a scan of the formed sheet and its pattern.";
  operation.inputs = inputs();
  operation.parameters = describe_parameters<ScanRegistrationOptions>();
  operation.outputs = outputs();
  operation.report = report_fields();
  operation.check = [](const Json& parameters) { read_parameters<ScanRegistrationOptions>(parameters); };
  operation.run = run_register;
  return operation;
}

}  // namespace formwright
