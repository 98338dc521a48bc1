// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/contract/operation_options.h"
#include "job/operations/thermoform/thermoform_operations.h"

#include "geometry/mesh/adjacency.h"
#include "formats/mesh_io.h"
#include "geometry/mesh/measures.h"
#include "job/operations/thermoform/thermoform_input.h"
#include "thermoform/mould/draft_map.h"
#include "thermoform/mould/mould.h"
#include "thermoform/mould/mould_parts.h"
#include "thermoform/mould/solid_shapes.h"
#include "thermoform/sheet/sheet_presets.h"

namespace formwright {
namespace {

constexpr int draft_cells = 256;  // across the model's longer side: 0.4 mm of 100 mm, a nozzle

std::vector<OutputInfo> thermoform_mould_outputs() {
  return {
      {"mould.stl", "model/stl", "STL", "All parts of the mould side by side on the bed of the 3D printer, watertight.",
       true},
      {"mould.3mf", "model/3mf", "3MF", "The mould for a slicer, every part as a separate object.", true},
      {"draft.ply", "application/x-ply", "Undercut map",
       "The model above the plate in machine coordinates, with draft angle, undercut and ratio of depth to width at every vertex.",
       true},
      {"mould.glb", "model/gltf-binary", "GLB", "The parts of the mould as printed, for viewing.", true}};
}

std::vector<ReportField> thermoform_mould_report_fields() {
  return {
      {"vertices", "Vertices", "", "Number of vertices of the repaired model."},
      {"faces", "Triangles", "", "Number of triangles of the repaired model."},
      {"mould_faces", "Triangles of the mould", "", "Number of triangles of all parts of the mould together."},
      {"watertight", "Watertight", "", "Whether no part of the mould has holes; checked on the result."},
      {"parts", "Parts", "",
       "Every part with its place in the mould (counted along the machine's x, y and z), size in mm, volume in ml, and numbers of pins and sockets."},
      {"part_count", "Number of parts", "", "Number of parts to print."},
      {"size_mm", "Size of the mould", "mm", "Size of the assembled mould, all parts together."},
      {"model_size_mm", "Size of the model", "mm", "Size of the model above the base plate."},
      {"plastic_volume_ml", "Plastic volume", "ml",
       "Volume of all printed parts if solid. The infill set in the slicer needs less."},
      {"cast_volume_ml", "Volume of the cast", "ml",
       "Volume of the gypsum cast, or of the positive, including the base plate."},
      {"gypsum_g", "Gypsum powder", "g", "Weight of gypsum powder for the cast; 0 for a positive. Mix a tenth more."},
      {"water_g", "Water", "g", "Weight of water for the cast; 0 for a positive."},
      {"pour_opening_mm2", "Pour opening", "mm²",
       "Area of the opening through which gypsum is poured: the underside of the cast."},
      {"vents", "Vent holes", "",
       "Every vent hole with its position on the machine in mm, the time at which the sheet arrives there in s (-1: never), and the remaining gap in mm."},
      {"undercut_area_mm2", "Undercut area", "mm²",
       "Area of the model that lies under another part of it, so that the sheet cannot be lifted off."},
      {"draft_min_deg", "Smallest draft angle", "°",
       "Smallest angle between a wall and the vertical. Negative walls lean inwards and hold the sheet."},
      {"below_3_deg_area_mm2", "Area of steep walls", "mm²",
       "Area of walls with a draft angle below 3°, including undercuts. The sheet is hard to lift off there."},
      {"depth_to_width_max", "Deepest cavity", "",
       "Largest ratio of depth to width of a cavity. The sheet thins in deep, narrow cavities."},
      {"advice", "Advice", "", "What to change so that the mould works, as sentences."},
      {"notes", "Placement", "", "Decisions that were made automatically about the placement, as sentences."},
      {"repairs", "Repairs", "", "What was found wrong in the model and repaired, as sentences."},
      {"seconds_read", "Reading", "s", "Time for reading and repairing the file; 0 if it was read before."},
      {"seconds_form", "Forming", "s", "Time for the simulation that finds the places of the vent holes."},
      {"seconds_cut", "Cutting at the plate", "s",
       "Time for checking the model and cutting it at the plate; 0 if done before."},
      {"seconds_draft", "Draft map", "s", "Time for computing the draft map; 0 if done before."},
      {"seconds_mould", "Mould", "s", "Time for making the solid mould."},
      {"seconds_split", "Splitting", "s", "Time for cutting the mould into parts with pins and sockets."},
      {"seconds_write", "Writing", "s", "Time for writing the output files."},
      {"peak_memory_mb", "Peak memory", "MB", "Largest amount of memory that the process used."}};
}

/// The model as it stands on the plate, and what can be said about it before a mould is made.
struct PlacedSolid {
  ExactSolid model;
  TriangleMesh mesh;
  DraftMap draft;
  std::vector<std::string> notes;
};

std::shared_ptr<const PlacedSolid> place_solid(const OperationCall& call, const LoadedModel& loaded,
                                               const Placement& placement, const ThermoformMouldOptions& options,
                                               Json& report) {
  Json placed = write_parameters(static_cast<const PlacementOptions&>(options));
  placed["sheet_thickness_mm"] = options.sheet_thickness_mm;
  placed["foot_mm"] = write_parameters(options)["foot_mm"];
  placed["opening_mm"] = {options.clamp_opening_x_mm, options.clamp_opening_y_mm};
  const std::string family = "mould-solid:", key = family + loaded.key + ":" + placed.dump();
  report["seconds_cut"] = report["seconds_draft"] = 0.0;
  if (auto known = call.session.find<const PlacedSolid>(key)) return known;
  call.session.drop(family);
  auto solid = std::make_shared<PlacedSolid>();
  Stopwatch watch;
  {
    const auto span = call.context.span(0.3, 0.5, "Cutting the model at the plate");
    solid->model = model_on_plate(placement(loaded.model.mesh), options, solid->notes, call.context);
    solid->mesh = solid->model.mesh();
  }
  report["seconds_cut"] = watch.lap();
  {
    const auto span = call.context.span(0.5, 0.6, "Draft and undercuts");
    solid->draft = draft_map(solid->mesh, options.sheet_thickness_mm, draft_cells, call.context);
  }
  report["seconds_draft"] = watch.lap();
  std::shared_ptr<const PlacedSolid> kept = solid;
  // An exact point takes about a quarter of a kilobyte.
  call.session.keep(key, kept, 1e-6 * 400 * static_cast<double>(solid->mesh.V.rows()));
  return kept;
}

Json size_json(const Vec3& size) { return {size.x(), size.y(), size.z()}; }

Bytes write_draft(const DraftMap& draft, Context& context) {
  Model model;
  model.mesh = draft.mesh;
  Eigen::VectorXd undercut(draft.draft_deg.size());
  for (Eigen::Index i = 0; i < undercut.size(); ++i) undercut[i] = draft.undercut[static_cast<std::size_t>(i)];
  const std::vector<VertexColumn> columns{{"draft_deg", draft.draft_deg, ColumnKind::float64},
                                          {"undercut", undercut, ColumnKind::uint8},
                                          {"depth_to_width", draft.depth_to_width, ColumnKind::float64}};
  WriteOptions write;
  write.columns = columns;
  return write_model(model, MeshFormat::ply, write, context);
}

/// All parts in one model, a group each.
Model parts_model(const MouldParts& parts) {
  Model model;
  std::vector<TriangleMesh> meshes;
  for (const MouldPart& part : parts.parts) {
    model.face_group.insert(model.face_group.end(), static_cast<std::size_t>(part.mesh.F.rows()),
                            static_cast<int>(meshes.size()));
    model.group_names.push_back("part " + std::to_string(meshes.size() + 1));
    meshes.push_back(part.mesh);
  }
  model.mesh = collected(meshes);
  return model;
}

void report_parts(Json& report, const MouldParts& parts) {
  double volume_mm3 = 0;
  int faces = 0;
  bool watertight = true;
  Json list = Json::array();
  for (const MouldPart& part : parts.parts) {
    volume_mm3 += part.volume_mm3;
    faces += part.mesh.face_count();
    watertight = watertight && Adjacency(part.mesh).is_closed();
    list.push_back({{"cell", part.cell},
                    {"size_mm", size_json(part.size_mm)},
                    {"volume_ml", part.volume_mm3 / 1000},
                    {"pins", part.pins},
                    {"sockets", part.sockets}});
  }
  report["parts"] = list;
  report["part_count"] = parts.parts.size();
  report["mould_faces"] = faces;
  report["watertight"] = watertight;
  report["plastic_volume_ml"] = volume_mm3 / 1000;
}

OperationResult run_mould(const OperationCall& call, const Json& given) {
  const auto options = read_parameters<ThermoformMouldOptions>(merged_parameters(call, given));
  Context& context = call.context;
  OperationResult result;
  Json& report = result.report;
  Stopwatch watch;
  FormedModel formed;
  {
    const auto span = context.span(0, 0.3, options.vents > 0 ? "Forming the sheet" : "Reading the model");
    if (options.vents > 0) {
      formed = formed_model(call, options);
    } else {
      formed.loaded = load_model(call, "mould");
      formed.placement = place(formed.loaded->model.mesh, options, clamp_opening_mm(options));
    }
  }
  const LoadedModel& loaded = *formed.loaded;
  report["seconds_read"] = loaded.seconds_read + loaded.seconds_repair;
  report["seconds_form"] = std::max(0.0, watch.lap() - loaded.seconds_read - loaded.seconds_repair);
  const auto placed = place_solid(call, loaded, formed.placement, options, report);

  watch.lap();
  std::vector<Vent> vents;
  if (options.vents > 0)
    vents = find_vents(placed->mesh, about_the_model(*formed.sheet, formed.placement, formed.real_placement),
                       options.vents, options.vent_diameter_mm, options.vent_spacing_mm, context);
  Mould mould;
  {
    const auto span = context.span(0.6, 0.8, "Making the mould");
    mould = make_mould(placed->model, vents, options, context);
  }
  report["seconds_mould"] = watch.lap();
  MouldParts parts;
  {
    const auto span = context.span(0.8, 0.95, "Cutting into parts");
    parts = split_mould(mould.solid, options, context);
  }
  report["seconds_split"] = watch.lap();

  const DraftMap& draft = placed->draft;
  report["vertices"] = loaded.model.mesh.vertex_count();
  report["faces"] = loaded.model.mesh.face_count();
  report["size_mm"] = size_json(bounding_box(mould.solid.mesh()).size());
  report["model_size_mm"] = size_json(bounding_box(placed->mesh).size());
  report_parts(report, parts);
  const TriangleMesh body = mould.body.mesh();
  const double cast_ml = signed_volume(body) / 1000;
  const bool negative = options.kind == MouldKind::negative;
  const Mixture mixture = plaster_mixture(cast_ml, options.water_to_plaster_ratio);
  report["cast_volume_ml"] = cast_ml;
  report["gypsum_g"] = negative ? Json(mixture.plaster_g) : Json(nullptr);
  report["water_g"] = negative ? Json(mixture.water_g) : Json(nullptr);
  report["pour_opening_mm2"] = negative ? Json(base_area_mm2(body, -options.base_mm)) : Json(nullptr);
  report["vents"] = Json::array();
  for (const Vent& vent : vents)
    report["vents"].push_back({{"x_mm", vent.position_mm.x()},
                               {"y_mm", vent.position_mm.y()},
                               {"z_mm", vent.position_mm.z()},
                               {"contact_s", vent.contact_s},
                               {"gap_mm", vent.gap_mm}});
  report["undercut_area_mm2"] = draft.undercut_area_mm2;
  report["draft_min_deg"] = draft.draft_min_deg;
  report["below_3_deg_area_mm2"] = draft.below_3_deg_area_mm2;
  report["depth_to_width_max"] = draft.depth_to_width_max;
  std::vector<std::string> advice = draft.sentences;
  advice.insert(advice.end(), parts.sentences.begin(), parts.sentences.end());
  if (static_cast<int>(vents.size()) < options.vents)
    advice.push_back("Air gathers at " + std::to_string(vents.size()) + (vents.size() == 1 ? " place" : " places") +
                     " of the model only: more vent holes would not help.");
  report["advice"] = advice;
  std::vector<std::string> notes = formed.placement.notes;
  notes.insert(notes.end(), placed->notes.begin(), placed->notes.end());
  report["notes"] = notes;
  report["repairs"] = loaded.repairs;

  context.progress(0.95, "Writing");
  const auto add = [&](const char* name, Bytes bytes) {
    for (const OutputInfo& info : thermoform_mould_outputs())
      if (info.name == name) result.outputs.push_back(make_output(info, std::move(bytes)));
    context.check_cancelled();
  };
  if (call.wants("draft.ply")) add("draft.ply", write_draft(draft, context));
  if (call.wants("mould.stl") || call.wants("mould.3mf") || call.wants("mould.glb")) {
    Model model = parts_model(parts);
    WriteOptions write;
    write.name = "mould";
    if (call.wants("mould.stl")) add("mould.stl", write_model(model, MeshFormat::stl, write, context));
    write.object_per_group = true;
    if (call.wants("mould.3mf")) add("mould.3mf", write_model(model, MeshFormat::three_mf, write, context));
    if (call.wants("mould.glb")) {
      // glTF's y is up.
      const Eigen::VectorXd y = model.mesh.V.col(1);
      model.mesh.V.col(1) = model.mesh.V.col(2);
      model.mesh.V.col(2) = -y;
      add("mould.glb", write_model(model, MeshFormat::glb, write, context));
    }
  }
  report["seconds_write"] = watch.lap();
  return result;
}

}  // namespace

Operation thermoform_mould_operation() {
  Operation operation;
  operation.name = "thermoform-mould";
  operation.title = "Mould";
  operation.summary = "Makes the mould that the sheet is formed over: a negative to cast gypsum in, or a positive.";
  operation.inputs = {mould_input_info(), sheet_input_info(), profile_input_info()};
  operation.outputs = thermoform_mould_outputs();
  operation.report = thermoform_mould_report_fields();
  operation.presets = sheet_presets();
  take_mergeable_options<ThermoformMouldOptions>(operation, run_mould);
  return operation;
}

}  // namespace formwright
