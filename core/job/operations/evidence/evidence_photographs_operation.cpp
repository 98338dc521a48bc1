// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "base/index.h"
#include "base/statistics.h"
#include "evidence/photographs/photograph_measurement.h"
#include "imaging/picture/png_writer.h"
#include "job/contract/file_pack.h"
#include "job/contract/model_input.h"
#include "job/contract/operation_options.h"
#include "job/operations/evidence/evidence_registration_operations.h"
#include "thermoform/measured/measured_object.h"

namespace formwright {
namespace {

constexpr double seen_px = 800;  // longer side of seen.png

void report_sights(Json& report, const MarkSheet& sheet, const PhotographMeasurement& m) {
  report["marks"] = sheet.marks.size();
  for (std::size_t k = 0; k < EnumNames<MarkSight>::names.size(); ++k)
    report["marks_" + std::string(EnumNames<MarkSight>::names[k])] =
        std::count(m.sights.begin(), m.sights.end(), static_cast<MarkSight>(k));
  report["marks_left_out"] = Json::array();
  double measured = 0, photographs = 0;
  for (std::size_t i = 0; i < sheet.marks.size(); ++i) {
    if (m.sights[i] == MarkSight::measured) {
      measured += 1;
      photographs += m.photographs_of[i];
      continue;
    }
    report["marks_left_out"].push_back({{"number", sheet.marks[i].number},
                                        {"sheet_mm", {sheet.marks[i].centre_mm.x(), sheet.marks[i].centre_mm.y()}},
                                        {"reason", EnumNames<MarkSight>::names[static_cast<std::size_t>(m.sights[i])]},
                                        {"photographs", m.photographs_of[i]}});
  }
  report["photographs_a_mark"] = measured > 0 ? photographs / measured : 0.0;
}

void report_cameras(Json& report, const PhotographMeasurement& m) {
  constexpr double film_mm = 36;  // width of the film that focal lengths of phones are compared with
  report["photographs"] = Json::array();
  for (const CameraReport& c : m.cameras)
    report["photographs"].push_back({{"file", c.file_name},
                                     {"pixels", {c.width, c.height}},
                                     {"sheet_marks", c.sheet_marks},
                                     {"board_marks", c.board_marks},
                                     {"used", c.used},
                                     {"reprojection_rms_px", c.rms_px},
                                     {"camera_mm", {c.centre_mm.x(), c.centre_mm.y(), c.centre_mm.z()}}});
  report["lenses"] = Json::array();
  for (const Lens& lens : m.lenses)
    report["lenses"].push_back({{"pixels", {lens.width, lens.height}},
                                {"focal_px", lens.focal_px},
                                {"focal_on_film_mm", lens.focal_px / lens.scale_px() * film_mm},
                                {"centre_px", {lens.centre_px.x(), lens.centre_px.y()}},
                                {"k1", lens.k1},
                                {"k2", lens.k2}});
}

Bytes photographed_csv(const PhotographMeasurement& m) {
  std::vector<MeasuredPoint> points;
  for (const PhotographedPoint& p : m.points) points.push_back({p.sheet_mm, p.place_mm, p.sigma_mm});
  return to_bytes(write_measured_points(points));
}

OperationResult run_photographs(const OperationCall& call, const PhotographOptions& options) {
  Context& context = call.context;
  const MarkSheet sheet = read_mark_sheet(*call.inputs.at("pattern").bytes);
  std::vector<Photograph> photographs;
  for (const auto& [own, input] : inputs_named(call, "photograph"))
    photographs.push_back({own, input->file_name.empty() ? own : input->file_name, *input->bytes});
  PhotographMeasurement m;
  {
    const auto span = context.span(0, 0.97, "Finding marks");
    m = measure_photographs(photographs, sheet, options, context);
  }
  context.progress(0.97, "Writing");
  OperationResult result;
  Json& report = result.report;
  std::vector<double> sigma;
  for (const PhotographedPoint& p : m.points) sigma.push_back(p.sigma_mm);
  report["points"] = m.points.size();
  report_sights(report, sheet, m);
  report["sigma_median_mm"] = median(sigma);
  report["sigma_95_mm"] = value_of_rank(sigma, sigma.size() * 95 / 100);
  report["reprojection_rms_px"] = m.rms_px;
  report["noise"] = m.noise;
  report["observations"] = m.observations;
  report["outliers"] = m.outliers;
  report_cameras(report, m);
  report["board_scale"] = m.board_scale;
  report["board_misfit_mm"] = m.board_misfit_mm;
  report["seconds_find"] = m.seconds_find;
  report["seconds_solve"] = m.seconds_solve;
  report["notes"] = m.notes;
  const Operation declaration = evidence_photographs_declaration();
  const auto add = [&](const char* name, const auto& bytes) {
    if (call.wants(name)) result.outputs.push_back(make_output(*declaration.output(name), bytes()));
    context.check_cancelled();
  };
  add("measured.csv", [&] { return photographed_csv(m); });
  add("seen.png", [&] { return write_png(draw_sights(sheet, m, sheet.sheet_mm.maxCoeff() / seen_px), 0, context); });
  report["peak_memory_mb"] = context.peak_memory_mb();
  return result;
}

}  // namespace

Operation evidence_photographs_operation() {
  Operation operation = evidence_photographs_declaration();
  take_options<PhotographOptions>(operation, run_photographs);
  return operation;
}

}  // namespace formwright
