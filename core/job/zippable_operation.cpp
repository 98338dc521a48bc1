// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/zippable_operation.h"

#include <algorithm>

#include "geometry/adjacency.h"
#include "geometry/io/mesh_io.h"
#include "job/model_input.h"
#include "zippable/design_files.h"

namespace formwright {
namespace {

std::vector<InputInfo> inputs() {
  InputInfo segments;
  segments.name = "segments";
  segments.label = "Parts";
  segments.help =
      "segments.json: punctures, loops and lines that bound the parts, where the zipper begins and ends (docs/zippable.md). Without it limbs are found.";
  segments.extensions = {"json"};
  segments.required = false;
  return {model_input_info(), segments};
}

std::vector<OutputInfo> outputs() {
  return {{"design.json", "application/json", "Design",
           "Parts, zipper and ribbon in space and in the plane, for the next steps.", true},
          {"parameterised.ply", "application/x-ply", "Parameterised model",
           "The parts with u, v in mm, part number and distortion.", true},
          {"curve.obj", "model/obj", "Zipper's course", "Polylines on the model.", true},
          {"formed.ply", "application/x-ply", "Zipped ribbon", "The ribbon as it lies in space.", true},
          {"ribbon.svg", "image/svg+xml", "Flat ribbon", "Unfolded at true size; parts of it may overlap.", true}};
}

std::vector<ReportField> report_fields() {
  return {
      {"vertices", "Vertices", "", "of the divided model"},
      {"faces", "Triangles", "", "of the divided model"},
      {"parts", "Parts", "", "of the model"},
      {"cylinders", "Cylinders", "", "how many of the parts are, which all must be"},
      {"interfaces", "Interfaces", "", "arcs that two parts share"},
      {"handles_cut", "Cut handles", "", "loops opened, which need another closure than the zipper"},
      {"hook_and_loop_mm_total", "Cuts to close by tape", "mm",
       "of cut handles and slits, along all of them; tape needed for each side"},
      {"distortion_mean", "Mean distortion", "", "symmetric Dirichlet energy over 4, weighted by area; 1 is none"},
      {"distortion_max", "Largest distortion", "", "of any triangle"},
      {"iterations", "Iterations", "", "Newton steps of the parameterisation"},
      {"constraint_residual_mm", "Constraint residual", "mm",
       "largest violation of seams, straight lines and interfaces"},
      {"order", "Order of parts", "", "as the zipper visits them, numbered from 0"},
      {"orders", "Possible orders", "", "to choose from with traversal"},
      {"order_taken", "Order taken", "", "which of them, from 1"},
      {"centre_radius_min_mm", "Tightest bend", "mm",
       "least radius of the flat ribbon's middle, over half its width to either side"},
      {"centre_radius_min_part", "Part of the tightest bend", "", "counted from 1"},
      {"unevenness", "Unevenness of crossings", "", "eq. (5.7) over the parts between; 0 is even"},
      {"windings", "Windings", "", "of every part"},
      {"crease_mm", "Creases along windings", "mm", "how much of them runs nearly like the windings"},
      {"crease_off_even_mm", "From even windings", "mm", "mean distance of these creases to the nearest even winding"},
      {"crease_off_mm", "From windings", "mm", "the same, of windings as drawn"},
      {"winding_spacing_least", "Least spacing", "", "of windings moved onto creases, of the even spacing"},
      {"fermat_spirals", "Fermat spirals", "", "parts that the zipper enters and leaves"},
      {"zipper_length_mm", "Zipper length", "mm", "one side of the ribbon, along its corners"},
      {"curve_length_mm", "Curve length", "mm", "on the model itself"},
      {"ribbon_width_mean_mm", "Mean width", "mm", "over the rulings between windings"},
      {"ribbon_width_min_mm", "Least width", "mm", "the same"},
      {"ribbon_triangles", "Ribbon triangles", "", "none has a corner off the boundary"},
      {"ribbon_size_mm", "Flat size", "mm", "width and height of the unfolded ribbon"},
      {"isometry_error", "Unfolding error", "", "largest relative change of an edge"},
      {"ribbon_to_model_mean_mm", "Mean distance to the model", "mm", "from the zipped ribbon"},
      {"ribbon_to_model_max_mm", "Largest distance to the model", "mm", "from the zipped ribbon"},
      {"model_to_ribbon_mean_mm", "Mean distance to the ribbon", "mm", "from the model"},
      {"model_to_ribbon_max_mm", "Largest distance to the ribbon", "mm", "from the model"},
      {"fabric_area_mm2", "Area of each fabric", "mm²", "of two colours, before room is made for the zipper"},
      {"fabric_seams", "Seams between fabrics", "", "rulings where one colour is joined to the other"},
      {"interleaved_share", "Zipper between two colours", "", "share of its length with another colour on either side"},
      {"size_mm", "Size", "mm", "of the zipped ribbon"},
      {"reused", "Parameterisation reused", "", "from an earlier job on the same model, parts and punctures"},
      {"seconds_read", "Reading", "s", "file to repaired model; 0 when known from before"},
      {"seconds_parts", "Parts", "s", "handles, limbs, division, punctures"},
      {"seconds_parameterisation", "Parameterisation", "s", "set-up, start and Newton steps"},
      {"seconds_curve", "Curve", "s", "orders, crossings, tracing"},
      {"seconds_ribbon", "Ribbon", "s", "rulings, triangles, unfolding"},
      {"seconds_distance", "Distances", "s", "between ribbon and model"},
      {"seconds_write", "Writing", "s", "outputs into their formats"},
      {"peak_memory_mb", "Peak memory", "MB", "of the process"},
      {"repairs", "Repairs", "", "what was found in the model and mended, in words"},
      {"notes", "Notes", "", "what was decided for you, in words"}};
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
    report["winding_spacing_least"] = design.alignment->spacing_least;
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
  if (call.wants("design.json")) result.outputs.push_back(make_output(outputs().front(), write_parts_json(model)));
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

OperationResult run(const OperationCall& call) {
  const auto options = read_parameters<ZippableOptions>(call.parameters);
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
    for (const OutputInfo& info : outputs())
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
  operation.summary = "Turns a model into one flat ribbon that zips up into it (thesis chapter 5).";
  operation.inputs = inputs();
  operation.parameters = describe_parameters<ZippableOptions>();
  operation.outputs = outputs();
  operation.report = report_fields();
  operation.check = [](const Json& parameters) { read_parameters<ZippableOptions>(parameters); };
  operation.run = run;
  return operation;
}

}  // namespace formwright
