// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "evidence/registration/scan_registration.h"
#include "base/statistics.h"
#include "formats/mesh_io.h"
#include "imaging/picture/png_writer.h"
#include "job/contract/operation_options.h"
#include "job/operations/evidence/evidence_registration_operations.h"
#include "job/contract/model_input.h"
#include "thermoform/measured/measured_object.h"

namespace formwright {
namespace {

std::vector<InputInfo> inputs() {
  InputInfo scan = model_input_info();
  scan.name = "scan";
  scan.label = "Scan";
  scan.help = "A 3D scan of the formed sheet with its picture: GLB, OBJ with texture, or PLY with colours.";
  scan.accepts_sample = false;
  return {
      scan,
      {"pattern",
       "Pattern",
       "The pattern.json that evidence-pattern wrote together with the print.",
       {"json"},
       true,
       false,
       ""},
      {"material", "Material file", "The material file (MTL) that belongs to an OBJ model.", {"mtl"}, false, false, ""},
      {"texture",
       "Picture",
       "A PNG or JPEG picture that replaces the scan's own, placed by the scan's texture coordinates.",
       {"png", "jpg", "jpeg"},
       false,
       false,
       ""}};
}

std::vector<OutputInfo> outputs() {
  return {{"measured.csv", "text/csv", "Measured points",
           "Where each point of the flat sheet moved, with its uncertainty (format: docs/measured_data.md).", true},
          {"aligned.png", "image/png", "Scan on the sheet",
           "The colours of the scan mapped back to the flat sheet. It should look like the pattern.", true},
          {"flow.png", "image/png", "Displacement",
           "The displacement found beyond the four corners: hue is its direction, saturation its length.", true}};
}

std::vector<ReportField> report_fields() {
  return {
      {"points", "Measured points", "", "Number of measured points: rows of measured.csv."},
      {"points_without_evidence", "Points left out", "",
       "Number of points left out because they were not seen, too plain to match, or too uncertain."},
      {"sigma_median_mm", "Median uncertainty", "mm", "Median standard deviation of the points along the surface."},
      {"sigma_95_mm", "95 % of uncertainties below", "mm",
       "95 % of the points have a smaller standard deviation than this."},
      {"coordinates", "Coordinates", "",
       "Coordinate system of the measured points: rim (the machine's) or scan (the scanner's)."},
      {"rim_rms_mm", "Rim error", "mm",
       "Root mean square distance of the scanned rim from where the machine holds it; null if no rim was scanned."},
      {"rim_scale", "Scale of the rim", "",
       "Length on the flat sheet divided by the same length in the scanned rim; 1 is correct, null if no rim was scanned."},
      {"corner_likeness", "Match of the corner marks", "",
       "Correlation of each corner mark with the pattern, at most 1. 0 if it was not found or was given by hand."},
      {"corner_px", "Corners in the picture", "px",
       "Position of each corner mark in the scan's picture, x and y from the top left; null if the picture does not show it."},
      {"corner_residual_mm", "Corner errors", "mm",
       "Distance between each corner mark as found and its final position; -1 if unknown."},
      {"colour_rms_levels", "Colour correction error", "",
       "Difference of the mean colours that remains after colour correction, in grey levels from 0 to 255."},
      {"colour_error_levels", "Colour difference", "",
       "Root mean square colour difference between matched scan and pattern over all pixels, in grey levels from 0 to 255."},
      {"likeness", "Match", "", "Correlation of scan and pattern after matching; 1 is a perfect match."},
      {"blur_px", "Blur", "px", "How much less sharp the scan is than the print, in pixels of the compared pictures."},
      {"pixel_mm", "Compared pixel", "mm", "Length on the sheet of one pixel of the compared pictures."},
      {"displacement_first_mm", "First displacement", "mm",
       "Root mean square displacement found by the first comparison, beyond what the four corners give."},
      {"displacement_last_mm", "Last correction", "mm",
       "Root mean square displacement added by the last comparison. Small if the matching has converged."},
      {"flow_full_colour_mm", "Longest displacement shown", "mm",
       "Displacement that flow.png shows in its strongest colour."},
      {"flattening_stretch_rms", "Flattening stretch", "",
       "Root mean square stretch of the scan when it is laid flat; 0 is none."},
      {"flattening_flipped", "Flipped triangles", "",
       "Number of triangles that are upside down in the flattened scan."},
      {"plane_scale", "Scale by the corners", "",
       "Length on the sheet divided by the same length in the flattened scan, from the corner marks."},
      {"scan_faces", "Faces", "", "Number of triangles of the scan."},
      {"other_parts", "Other parts", "",
       "Number of parts of the scan that are not joined to the sheet and were left out."},
      {"holes", "Holes", "", "Number of holes in the scan of the sheet."},
      {"seconds_read", "Reading", "s", "Time for reading scan and picture."},
      {"seconds_flatten", "Flattening", "s", "Time for laying the scan flat."},
      {"seconds_marks", "Marks", "s", "Time for finding the corner marks."},
      {"seconds_draw", "Drawing", "s", "Time for drawing scan and pattern on the flat sheet."},
      {"seconds_flow", "Comparing", "s", "Time for comparing the pictures at three resolutions."},
      {"seconds_points", "Points", "s", "Time for measuring the points and drawing the pictures of the result."},
      {"peak_memory_mb", "Peak memory", "MB", "Largest amount of memory that the process used."},
      {"notes", "Notes", "", "What to know about the result, as sentences."}};
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
  report["points"] = r.points.size();
  report["points_without_evidence"] = r.points_without_evidence;
  report["sigma_median_mm"] = median(sigma);
  report["sigma_95_mm"] = value_of_rank(sigma, sigma.size() * 95 / 100);
  report["coordinates"] = r.in_machine_coordinates ? "rim" : "scan";
  report["rim_rms_mm"] = r.rim_rms_mm ? Json(*r.rim_rms_mm) : Json(nullptr);
  report["rim_scale"] = r.rim_scale ? Json(*r.rim_scale) : Json(nullptr);
  report["corner_likeness"] = r.marks.similarity;
  report["corner_px"] = Json::array();
  for (const std::optional<Vec2>& px : r.corner_px)
    report["corner_px"].push_back(px ? Json{px->x(), px->y()} : Json(nullptr));
  report["corner_residual_mm"] = r.corner_residual_mm;
  report["colour_rms_levels"] = r.colours.rms_levels;
  report["colour_error_levels"] = r.colour_error_levels;
  report["likeness"] = r.similarity;
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

OperationResult run_register(const OperationCall& call, const ScanRegistrationOptions& options) {
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
      "Finds where every point of a printed sheet moved, from a scan of the formed sheet and its pattern.";
  operation.inputs = inputs();
  operation.outputs = outputs();
  operation.report = report_fields();
  take_options<ScanRegistrationOptions>(operation, run_register);
  return operation;
}

}  // namespace formwright
