// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "base/error.h"
#include "formats/mesh_io.h"
#include "geometry/mesh/measures.h"
#include "job/contract/model_input.h"
#include "job/contract/operation_options.h"
#include "job/operations/zippable/zippable_operation.h"
#include "zippable/design_files.h"
#include "zippable/plan/zippable_plan.h"
#include "zippable/strips/strip_model.h"

namespace formwright {
namespace {

std::vector<OutputInfo> zippable_baseline_outputs() {
  return {{"strips.svg", "image/svg+xml", "Strips, SVG",
           "All sheets side by side at true size, with the layers cut and engrave.", true},
          {"strips.ply", "application/x-ply", "Strips in space", "The shape that the strips make.", true}};
}

std::vector<ReportField> zippable_baseline_report_fields() {
  return {
      {"parts", "Parts", "", "Number of parts between feature lines and limbs."},
      {"bands", "Bands", "", "Number of bands that follow the borders of the parts."},
      {"pieces", "Pieces", "", "Number of pieces to cut; none overlaps itself."},
      {"sheets", "Sheets", "", "Number of sheets needed."},
      {"cut_length_mm", "Cut length", "mm", "Total length of all outlines to cut."},
      {"narrowest_mm", "Narrowest piece", "mm",
       "Width of the narrowest piece: twice its area divided by the length of its outline."},
      {"hausdorff_mm", "Hausdorff distance", "mm",
       "Largest distance between strips and model, measured in both directions (Hausdorff distance)."},
      {"strips_to_model_mean_mm", "Mean distance to the model", "mm", "Mean distance from the strips to the model."},
      {"model_to_strips_mean_mm", "Mean distance to the strips", "mm", "Mean distance from the model to the strips."},
      {"isometry_error", "Unfolding error", "",
       "Largest relative change of an edge's length when laid flat; practically 0."},
      {"zippable_pieces", "Pieces of the zippable", "",
       "Number of pieces of the zippable as a paper model with the same width and sheet size."},
      {"zippable_cut_length_mm", "Cut length of the zippable", "mm",
       "Total length of all outlines to cut for the zippable as a paper model."},
      {"zippable_narrowest_mm", "Narrowest piece of the zippable", "mm",
       "Width of the narrowest piece of the zippable: twice its area divided by the length of its outline."},
      {"zippable_hausdorff_mm", "Hausdorff distance of the zippable", "mm",
       "Largest distance between zippable and model in both directions, including the holes at its tips, which strips do not have."},
      {"zippable_to_model_mean_mm", "Mean distance of the zippable", "mm",
       "Mean distance from the zippable to the model."},
      {"model_to_zippable_mean_mm", "Mean distance to the zippable", "mm",
       "Mean distance from the model to the zippable."},
      {"zippable_ribbon_width_min_mm", "Smallest width of the zippable", "mm",
       "Smallest width of the zippable's ribbon between windings."},
      {"seconds_strips", "Strips", "s", "Time for making the strips and laying them flat."},
      {"seconds_zippable", "Zippable", "s", "Time for designing and planning the zippable."},
      {"peak_memory_mb", "Peak memory", "MB", "Largest amount of memory that the process used."},
      {"repairs", "Repairs", "", "What was found wrong in the model and repaired, as sentences."},
      {"notes", "Notes", "", "What to know about the result, as sentences."}};
}

/// The limbs that a zippable is divided into, on the faces of the whole model.
std::vector<int> limbs_on(const TriangleMesh& mesh, const Segmentation& s) {
  const PointDistance divided(s.mesh);
  std::vector<int> limb(std::size_t(mesh.face_count()), 0);
  for (int f = 0; f < mesh.face_count(); ++f) {
    const Vec3 middle =
        (mesh.V.row(mesh.F(f, 0)) + mesh.V.row(mesh.F(f, 1)) + mesh.V.row(mesh.F(f, 2))).transpose() / 3;
    if (const auto nearest = divided.nearest(middle)) limb[f] = s.face_segment[nearest->face];
  }
  return limb;
}

void report_zippable(Json& report, ParameterisedModel& model, const ZippableOptions& options,
                     const StripOptions& strips, Context& context) {
  model.parameterisation = parameterise(model.proposal.segmentation, {}, context);
  const ZippableDesign design = design_zippable(model, options, context);
  const FlatDesign flat = read_flat_design(write_design_json(model, design));
  PlanOptions paper;
  paper.coil = ZipperCoil::none;
  paper.seam_allowance_mm = paper.kerf_mm = 0;
  paper.bed_x_mm = strips.bed_x_mm, paper.bed_y_mm = strips.bed_y_mm;
  const ZippablePlan plan = plan_zippable(flat, paper, context);
  std::vector<Polygon> outlines;
  for (const PlanPiece& piece : plan.pieces.pieces) outlines.push_back(piece.outline_mm);
  const PieceFigures figures = piece_figures(outlines);
  report["zippable_pieces"] = figures.pieces;
  report["zippable_cut_length_mm"] = figures.cut_length_mm;
  report["zippable_narrowest_mm"] = figures.narrowest_mm;
  report["zippable_hausdorff_mm"] = std::max(design.ribbon_to_model->maximum, design.model_to_ribbon->maximum);
  report["zippable_to_model_mean_mm"] = design.ribbon_to_model->mean;
  report["model_to_zippable_mean_mm"] = design.model_to_ribbon->mean;
  report["zippable_ribbon_width_min_mm"] = design.ribbon.width_min_mm;
}

OperationResult run_zippable_baseline(const OperationCall& call, const StripOptions& options) {
  Context& context = call.context;
  std::shared_ptr<const LoadedModel> loaded;
  {
    const auto span = context.span(0, 0.1, "Reading the model");
    loaded = load_model(call);
  }
  ZippableOptions zippable;
  zippable.width_mm = options.width_mm, zippable.size_mm = options.size_mm;
  OperationResult result;
  std::vector<std::string> notes;
  Stopwatch watch;
  ParameterisedModel model = divide_model(loaded->model.mesh, {}, zippable, context);
  const StripModel strips = [&] {
    const auto span = context.span(0.1, 0.5, "Unfolding strips");
    return make_strips(model.mesh, limbs_on(model.mesh, model.proposal.segmentation), options, context);
  }();
  const std::vector<CutSheet> sheets = strip_sheets(strips, options, context);
  result.report["seconds_strips"] = watch.lap();
  std::vector<Polygon> outlines;
  for (const StripPiece& piece : strips.pieces) outlines.push_back(piece.outline_mm);
  const PieceFigures figures = piece_figures(outlines);
  const double spacing = std::max(0.25 * options.width_mm, 5e-3 * bounding_box(model.mesh).size().maxCoeff());
  const SurfaceDistance there = surface_distance(strips.formed, PointDistance(model.mesh), spacing, context),
                        back = surface_distance(model.mesh, PointDistance(strips.formed), spacing, context);
  result.report["parts"] = strips.parts;
  result.report["bands"] = strips.bands;
  result.report["pieces"] = figures.pieces;
  result.report["sheets"] = sheets.size();
  result.report["cut_length_mm"] = figures.cut_length_mm;
  result.report["narrowest_mm"] = figures.narrowest_mm;
  result.report["hausdorff_mm"] = std::max(there.maximum, back.maximum);
  result.report["strips_to_model_mean_mm"] = there.mean;
  result.report["model_to_strips_mean_mm"] = back.mean;
  result.report["isometry_error"] = strips.isometry_error;
  notes = strips.notes;
  watch.lap();
  if (options.compare) {
    const auto span = context.span(0.5, 1, "Designing the zippable");
    try {
      report_zippable(result.report, model, zippable, options, context);
    } catch (const Error& error) {
      if (error.code() == ErrorCode::cancelled) throw;
      notes.push_back(std::string("No zippable stands beside: ") + error.what());
    }
  }
  result.report["seconds_zippable"] = watch.lap();
  const auto add = [&](const char* name, auto&& bytes) {
    if (!call.wants(name)) return;
    for (const OutputInfo& info : zippable_baseline_outputs())
      if (info.name == name) result.outputs.push_back(make_output(info, bytes()));
  };
  add("strips.svg", [&] { return write_svg(side_by_side(sheets, 20)); });
  add("strips.ply", [&] {
    Model formed;
    formed.mesh = strips.formed;
    return write_model(formed, MeshFormat::ply, context);
  });
  result.report["repairs"] = loaded->repairs;
  result.report["notes"] = notes;
  return result;
}

}  // namespace

Operation zippable_baseline_operation() {
  Operation operation;
  operation.name = "zippable-baseline";
  operation.title = "Strips to compare with";
  operation.summary = "Makes the model from paper strips (Mitani and Suzuki 2004), to compare with the zippable.";
  operation.inputs = {model_input_info()};
  operation.outputs = zippable_baseline_outputs();
  operation.report = zippable_baseline_report_fields();
  take_options<StripOptions>(operation, run_zippable_baseline);
  return operation;
}

}  // namespace formwright
