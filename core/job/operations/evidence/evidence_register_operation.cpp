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
  const Operation declaration = evidence_register_declaration();
  const auto add = [&](const char* name, const auto& bytes) {
    if (!call.wants(name)) return;
    for (const OutputInfo& info : declaration.outputs)
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
  Operation operation = evidence_register_declaration();
  take_options<ScanRegistrationOptions>(operation, run_register);
  return operation;
}

}  // namespace formwright
