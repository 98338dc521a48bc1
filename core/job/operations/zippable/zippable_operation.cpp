// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/contract/operation_options.h"
#include "job/operations/zippable/zippable_operation.h"

#include <algorithm>

#include "geometry/mesh/adjacency.h"
#include "formats/mesh_io.h"
#include "job/contract/model_input.h"
#include "zippable/design_files.h"

namespace formwright {
namespace {

std::vector<InputInfo> zippable_inputs() {
  InputInfo segments;
  segments.name = "segments";
  segments.label = "Parts";
  segments.help =
      "A segments.json with the holes, loops and lines that bound the parts, and where the zipper starts and ends. Without it, limbs are found automatically.";
  segments.extensions = {"json"};
  segments.required = false;
  return {model_input_info(), segments};
}

std::vector<OutputInfo> zippable_outputs() {
  return {
      {"design.json", "application/json", "Design",
       "The design: parts, zipper and ribbon, zipped and flat. Needed by the plan and the simulation.", true},
      {"parameterised.ply", "application/x-ply", "Parts laid flat",
       "The parts of the model laid flat: u and v in mm, part number and distortion at every vertex.", true},
      {"curve.obj", "model/obj", "Line of the zipper", "The line of the zipper on the model.", true},
      {"formed.ply", "application/x-ply", "Zipped ribbon", "The ribbon in its zipped shape.", true},
      {"ribbon.svg", "image/svg+xml", "Flat ribbon", "The flat ribbon at true size; parts of it may overlap.", true}};
}

std::vector<ReportField> zippable_report_fields() {
  return {
      {"vertices", "Vertices", "", "Number of vertices of the model after it was divided into parts."},
      {"faces", "Triangles", "", "Number of triangles of the model after it was divided into parts."},
      {"parts", "Parts", "", "Number of parts into which the model was divided."},
      {"cylinders", "Cylinders", "", "Number of parts that are cylinders, as all must be."},
      {"interfaces", "Interfaces", "", "Number of lines along which two parts meet."},
      {"handles_cut", "Cut handles", "",
       "Number of handles that were cut open; these cuts are closed with tape instead of the zipper."},
      {"hook_and_loop_mm_total", "Cuts to close with tape", "mm",
       "Total length of cut handles and slits; that much tape is needed for each side."},
      {"distortion_mean", "Mean distortion", "",
       "Mean distortion when the parts are laid flat (symmetric Dirichlet energy divided by 4); 1 is none."},
      {"distortion_max", "Largest distortion", "", "Largest distortion of any triangle when laid flat; 1 is none."},
      {"iterations", "Iterations", "", "Number of Newton steps for laying the parts flat."},
      {"constraint_residual_mm", "Constraint residual", "mm",
       "Largest mismatch along seams, straight lines and borders of parts; practically 0."},
      {"order", "Order of parts", "", "Parts in the order in which the zipper visits them, numbered from 0."},
      {"orders", "Possible orders", "", "Number of possible orders; the parameter traversal chooses one."},
      {"order_taken", "Chosen order", "", "Number of the chosen order, from 1."},
      {"centre_radius_min_mm", "Tightest bend", "mm",
       "Smallest radius of the flat ribbon's centre line, measured over half its width to either side."},
      {"centre_radius_min_part", "Part of the tightest bend", "", "Number of the part with the tightest bend, from 1."},
      {"unevenness", "Unevenness of crossings", "", "How unevenly the zipper crosses from part to part; 0 is even."},
      {"windings", "Windings", "", "Number of turns of the zipper around every part."},
      {"crease_mm", "Creases along windings", "mm",
       "Length of creases that run in nearly the same direction as the windings."},
      {"crease_off_even_mm", "Distance to even windings", "mm",
       "Mean distance from these creases to the nearest winding if windings are equally spaced."},
      {"crease_off_mm", "Distance to windings", "mm",
       "Mean distance from these creases to the nearest winding as drawn."},
      {"min_winding_spacing", "Smallest spacing", "",
       "Smallest spacing of windings that were moved onto creases, as a fraction of the even spacing.",
       "winding_spacing_least"},
      {"fermat_spirals", "Fermat spirals", "",
       "Number of parts that the zipper enters and leaves, winding in and out as a double spiral."},
      {"zipper_length_mm", "Zipper length", "mm", "Length of the zipper: one side of the ribbon."},
      {"curve_length_mm", "Curve length", "mm", "Length of the zipper's line measured on the model."},
      {"ribbon_width_mean_mm", "Mean width", "mm", "Mean width of the ribbon between windings."},
      {"ribbon_width_min_mm", "Smallest width", "mm", "Smallest width of the ribbon between windings."},
      {"ribbon_triangles", "Ribbon triangles", "", "Number of triangles of the ribbon; all corners lie on its edge."},
      {"ribbon_size_mm", "Flat size", "mm", "Width and height of the flat ribbon."},
      {"isometry_error", "Unfolding error", "",
       "Largest relative change of an edge's length when laid flat; practically 0."},
      {"ribbon_to_model_mean_mm", "Mean distance to the model", "mm",
       "Mean distance from the zipped ribbon to the model."},
      {"ribbon_to_model_max_mm", "Largest distance to the model", "mm",
       "Largest distance from the zipped ribbon to the model."},
      {"model_to_ribbon_mean_mm", "Mean distance to the ribbon", "mm",
       "Mean distance from the model to the zipped ribbon."},
      {"model_to_ribbon_max_mm", "Largest distance to the ribbon", "mm",
       "Largest distance from the model to the zipped ribbon."},
      {"fabric_area_mm2", "Area of each fabric", "mm²",
       "Area of each of the two fabrics, before room is made for the zipper."},
      {"fabric_seams", "Seams between fabrics", "",
       "Number of seams across the ribbon where one fabric is joined to the other."},
      {"interleaved_share", "Zipper between two colours", "",
       "Fraction of the zipper's length with different fabrics on its two sides."},
      {"size_mm", "Size", "mm", "Size of the zipped ribbon."},
      {"reused", "Parameterisation reused", "",
       "Whether the parameterisation of an earlier job with the same model, parts and holes was used again."},
      {"seconds_read", "Reading", "s", "Time for reading and repairing the file; 0 if it was read before."},
      {"seconds_parts", "Parts", "s", "Time for dividing the model into parts."},
      {"seconds_parameterisation", "Parameterisation", "s", "Time for laying the parts flat."},
      {"seconds_curve", "Curve", "s", "Time for ordering the parts and drawing the zipper's line."},
      {"seconds_ribbon", "Ribbon", "s", "Time for making the ribbon and laying it flat."},
      {"seconds_distance", "Distances", "s", "Time for measuring distances between ribbon and model."},
      {"seconds_write", "Writing", "s", "Time for writing the output files."},
      {"peak_memory_mb", "Peak memory", "MB", "Largest amount of memory that the process used."},
      {"repairs", "Repairs", "", "What was found wrong in the model and repaired, as sentences."},
      {"notes", "Notes", "", "Decisions that were made automatically, as sentences."}};
}

/// Of the part on whose lines the triangle has a corner, or the first one.
int part_of_face(const ZippableDesign& design, int face) {
  for (int k = 0; k < 3; ++k)
    if (const int sample = design.ribbon.boundary[design.ribbon.F(face, k)].sample; sample >= 0)
      return design.curve.lines[design.curve.samples[sample].line].part;
  return design.traversal.traversal.parts.front();
}

void report_design(Json& report, const ParameterisedModel& model, const ZippableDesign& design) {
  const Segmentation& s = model.proposal.segmentation;
  const Ribbon& ribbon = design.ribbon;
  report["vertices"] = s.mesh.vertex_count();
  report["faces"] = s.mesh.face_count();
  report["parts"] = s.part_count();
  report["interfaces"] = s.interfaces.size();
  report["handles_cut"] = model.proposal.handles_cut;
  report["distortion_mean"] = model.parameterisation.distortion_mean;
  report["distortion_max"] = model.parameterisation.distortion_max;
  report["iterations"] = model.parameterisation.iterations;
  report["constraint_residual_mm"] = constraint_residual_mm(s, model.parameterisation);
  report["order"] = design.traversal.traversal.parts;
  report["orders"] = design.traversal_count;
  report["order_taken"] = design.traversal_number;
  report["cylinders"] = s.part_count();
  report["centre_radius_min_mm"] = design.bend ? Json(design.bend->radius_mm) : Json(nullptr);
  report["centre_radius_min_part"] = design.bend ? Json(part_of_face(design, design.bend->face) + 1) : Json(nullptr);
  report["unevenness"] = design.traversal.crossings.unevenness;
  report["windings"] = design.curve.windings;
  if (design.alignment) {
    report["crease_mm"] = design.alignment->crease_mm;
    report["crease_off_even_mm"] = design.alignment->off_before_mm;
    report["crease_off_mm"] = design.alignment->off_after_mm;
    report["min_winding_spacing"] = design.alignment->min_spacing;
  }
  report["fermat_spirals"] = design.curve.fermat_spirals;
  report["zipper_length_mm"] = ribbon.zipper_mm;
  report["curve_length_mm"] = design.curve.length_mm;
  report["ribbon_width_mean_mm"] = ribbon.width_mean_mm;
  report["ribbon_width_min_mm"] = ribbon.width_min_mm;
  report["ribbon_triangles"] = ribbon.F.rows();
  const Positions flat = ribbon.flat().V, formed = ribbon.formed().V;
  const Vec3 flat_size = (flat.colwise().maxCoeff() - flat.colwise().minCoeff()).transpose(),
             size = (formed.colwise().maxCoeff() - formed.colwise().minCoeff()).transpose();
  report["ribbon_size_mm"] = {flat_size.x(), flat_size.y()};
  report["isometry_error"] = ribbon.isometry_error;
  if (!ribbon.closures.empty()) {
    double total_mm = 0;
    for (const HandleClosure& closure : ribbon.closures) total_mm += closure.length_mm;
    report["hook_and_loop_mm_total"] = total_mm;
  }
  if (design.fabrics) {
    report["fabric_area_mm2"] = design.fabrics->area_mm2;
    report["fabric_seams"] = design.fabrics->seams;
    report["interleaved_share"] = design.fabrics->interleaved_share;
  }
  const auto distance = [&](const std::string& name, const std::optional<SurfaceDistance>& measured) {
    report[name + "_mean_mm"] = measured ? Json(measured->mean) : Json(nullptr);
    report[name + "_max_mm"] = measured ? Json(measured->maximum) : Json(nullptr);
  };
  distance("ribbon_to_model", design.ribbon_to_model);
  distance("model_to_ribbon", design.model_to_ribbon);
  report["size_mm"] = {size.x(), size.y(), size.z()};
  report["seconds_curve"] = design.seconds_curve;
  report["seconds_ribbon"] = design.seconds_ribbon;
  report["seconds_distance"] = design.seconds_distance;
}

/// The division alone, with what is wrong with its parts.
OperationResult check_parts(const OperationCall& call, const LoadedModel& loaded, const ZippableParts& parts,
                            const ZippableOptions& options) {
  const ParameterisedModel model = divide_model(loaded.model.mesh, parts, options, call.context);
  const Segmentation& s = model.proposal.segmentation;
  OperationResult result;
  if (call.wants("design.json"))
    result.outputs.push_back(make_output(zippable_outputs().front(), write_parts_json(model)));
  std::vector<std::string> notes = model.proposal.notes;
  for (int part = 0; part < s.part_count(); ++part)
    if (!s.problems[part].empty())
      notes.push_back("Part " + std::to_string(part + 1) + " is not a cylinder. " + s.problems[part]);
  result.report["parts"] = s.part_count();
  result.report["cylinders"] = std::count(s.problems.begin(), s.problems.end(), "");
  result.report["handles_cut"] = model.proposal.handles_cut;
  result.report["seconds_parts"] = model.seconds_parts;
  result.report["repairs"] = loaded.repairs;
  result.report["notes"] = notes;
  return result;
}

OperationResult run_zippable(const OperationCall& call, const ZippableOptions& options) {
  Context& context = call.context;
  ZippableParts parts;
  std::string parts_key = "automatic";
  if (const auto segments = call.inputs.find("segments"); segments != call.inputs.end()) {
    parts = read_segments(*segments->second.bytes);
    parts_key = segments->second.key();
  }
  std::shared_ptr<const LoadedModel> loaded;
  {
    const auto span = context.span(0, 0.1, "Reading the model");
    loaded = load_model(call);
  }
  if (options.check_parts) return check_parts(call, *loaded, parts, options);
  const std::string key = "zippable:" + loaded->key + ":" + parts_key + ":" + parameterisation_key(options, parts);
  auto model = call.session.find<const ParameterisedModel>(key);
  const bool reused = model != nullptr;
  if (!reused) {
    const auto span = context.span(0.1, 0.7, "Parameterising");
    model = std::make_shared<const ParameterisedModel>(parameterise_model(loaded->model.mesh, parts, options, context));
    call.session.keep(key, model, static_cast<double>(model->proposal.segmentation.mesh.face_count()) * 2e-4);
  }
  ZippableDesign design;
  {
    const auto span = context.span(0.7, 0.95, "Designing");
    design = design_zippable(*model, options, context);
  }
  context.progress(0.95, "Writing");
  Stopwatch watch;
  OperationResult result;
  const auto add = [&](const char* name, auto&& bytes) {
    if (!call.wants(name)) return;
    for (const OutputInfo& info : zippable_outputs())
      if (info.name == name) result.outputs.push_back(make_output(info, bytes()));
    context.check_cancelled();
  };
  add("design.json", [&] { return write_design_json(*model, design); });
  add("parameterised.ply", [&] { return write_parameterised_ply(*model, context); });
  add("curve.obj", [&] { return write_curve_obj(design); });
  add("formed.ply", [&] {
    Model zipped;
    zipped.mesh = design.ribbon.formed();
    return write_model(zipped, MeshFormat::ply, context);
  });
  add("ribbon.svg", [&] { return write_ribbon_svg(design); });
  report_design(result.report, *model, design);
  result.report["reused"] = reused;
  result.report["seconds_parts"] = reused ? 0.0 : model->seconds_parts;
  result.report["seconds_parameterisation"] = reused ? 0.0 : model->seconds_parameterisation;
  result.report["seconds_read"] = loaded->seconds_read + loaded->seconds_repair;
  result.report["seconds_write"] = watch.seconds();
  result.report["repairs"] = loaded->repairs;
  result.report["notes"] = design.notes;
  return result;
}

}  // namespace

Operation zippable_design_operation() {
  Operation operation;
  operation.name = "zippable-design";
  operation.title = "Zippable";
  operation.summary = "Turns a model into one flat ribbon that zips up into the model's shape.";
  operation.inputs = zippable_inputs();
  operation.outputs = zippable_outputs();
  operation.report = zippable_report_fields();
  take_options<ZippableOptions>(operation, run_zippable);
  return operation;
}

}  // namespace formwright
