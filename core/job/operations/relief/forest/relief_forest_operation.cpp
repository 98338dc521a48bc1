// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/operations/relief/forest/relief_forest_operation.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "base/format.h"
#include "formats/mesh_io.h"
#include "geometry/mesh/measures.h"
#include "imaging/picture/png_writer.h"
#include "job/contract/model_input.h"
#include "job/contract/operation_options.h"
#include "job/operations/relief/forest/forest_files.h"
#include "job/operations/relief/forest/forest_scene_file.h"
#include "relief/forest/forest_picture.h"

namespace formwright {
namespace {

constexpr double low_share = 0.9;  // of a model that is seen, below which a note says so

std::vector<InputInfo> forest_inputs() {
  return {
      scene_input_info(
          "Viewpoints and pillars as JSON, such as the scene.json of an earlier run. Without one, four samples are seen from four sides."),
      scene_models_info()};
}

std::vector<OutputInfo> forest_outputs() {
  return {
      {"pillars.zip", "application/zip", "Pillars, STL",
       "Every pillar with its relief and pin as a watertight solid, upright: pillar_01.stl and so on.", true},
      {"pillars.3mf", "model/3mf", "Pillars, 3MF", "All pillars where they stand, as objects of their own.", true},
      {"forest.glb", "model/gltf-binary", "Forest", "All pillars where they stand, for viewing.", true},
      {"floor_plan.svg", "image/svg+xml", "Floor plan, SVG",
       "The floor at true size: holes for the pins, outlines, numbers and how each pillar is turned.", true},
      {"floor_plan.dxf", "image/vnd.dxf", "Floor plan, DXF", "The floor plan in mm as DXF R12, to drill or laser.",
       true},
      {"pictures.zip", "application/zip", "Pictures", "The forest as seen from each viewpoint and from elsewhere.",
       true},
      {"models.zip", "application/zip", "Models from their viewpoints",
       "Each model as its viewpoint sees it, before it is spread over the pillars. Nothing is solved for it.", false},
      {"overview.png", "image/png", "All pictures", "The same pictures side by side.", false},
      {"scene.json", "application/json", "Scene", "Viewpoints and pillars, to edit and to run again.", true},
      {"plan.json", "application/json", "Seen from above",
       "What each viewpoint sees, and the surfaces that are its own, as lines in the floor plan. Without files of pillars nothing is solved for it.",
       false}};
}

std::vector<ReportField> forest_report_fields() {
  return {
      {"viewpoints", "Viewpoints", "",
       "For each viewpoint: its model, the number of pieces, which share of the lines of sight to the model meets its own piece, a bare surface, no pillar or a piece of another model, and its shading difference."},
      {"in_plan", "In the floor plan", "",
       "For each viewpoint: the share of its lines of sight, seen from above, that meets a pillar, and the share that meets a surface of its own."},
      {"seen_percent_min", "Model seen", "%",
       "Share of its model that is seen whole, of the viewpoint where it is smallest; by rays at the finished solids."},
      {"intrusion_percent_max", "Pieces of other models", "%",
       "Share of the picture that pieces of other models cover, of the viewpoint where it is largest; by rays at the finished solids."},
      {"pillars", "Pillars", "",
       "For each pillar: its number, the place of its pin, its size, its volume and the number of its pieces."},
      {"pillar_count", "Number of pillars", "", "How many pillars there are."},
      {"pieces", "Pieces", "", "Number of pieces of reliefs on all pillars."},
      {"unused_pillars", "Pillars without pieces", "", "Numbers of the pillars on which nothing is shown."},
      {"watertight", "Watertight", "", "Whether every solid has no holes, as slicers need; checked on the result."},
      {"volume_ml", "Volume", "ml", "Volume of all pillars with their pins."},
      {"floor_size_mm", "Size of the floor", "mm", "Width and depth of the floor plan."},
      {"hole_diameter_mm", "Holes", "mm", "Diameter of the holes for the pins."},
      {"seconds_read", "Reading", "s", "Time for reading and repairing the models; 0 if they were read before."},
      {"seconds_solve", "Solving", "s", "Time for solving the reliefs, including the factorisations."},
      {"seconds_solids", "Making the pillars", "s", "Time for joining the pieces to their pillars."},
      {"seconds_check", "Checking", "s", "Time for looking from the viewpoints."},
      {"seconds_write", "Writing", "s", "Time for writing the output files."},
      {"peak_memory_mb", "Peak memory", "MB", "Largest amount of memory that the process used."},
      {"repairs", "Repairs", "", "What was found wrong in the models and repaired, as sentences."},
      {"notes", "Notes", "", "What to know about the result, as sentences."}};
}

struct ForestInput {
  ForestSceneFile file;
  std::vector<std::shared_ptr<const LoadedModel>> models;  // of each viewpoint
  double seconds_read = 0;
};

ForestInput read_forest(const OperationCall& call, const ForestOptions& options) {
  ForestInput input;
  const auto scene = call.inputs.find(scene_input);
  input.file = scene == call.inputs.end() ? sample_forest_scene(options.scene_vertices)
                                          : read_forest_scene(*scene->second.bytes);
  const std::size_t count = input.file.models.size();
  for (std::size_t v = 0; v < count; ++v) {
    const double begin = static_cast<double>(v) / static_cast<double>(count);
    const auto span = call.context.span(begin, begin + 1 / static_cast<double>(count), "Reading the models");
    input.models.push_back(load_scene_model(call, input.file.models[v], "Viewpoint " + std::to_string(v + 1)));
    input.seconds_read += input.models.back()->seconds_read + input.models.back()->seconds_repair;
  }
  return input;
}

/// From the session, or made and kept there.
std::shared_ptr<ReliefSolver> kept_solver(const OperationCall& call, const LoadedModel& loaded,
                                          const ReliefOptions& options, Context& context) {
  const std::string key = "relief-forest:" + loaded.key + ":" + ReliefSolver::key(options);
  if (auto solver = call.session.find<ReliefSolver>(key)) return solver;
  auto solver = std::make_shared<ReliefSolver>(loaded.model.mesh, options, context);
  call.session.keep(key, solver, solver->memory_mb());
  return solver;
}

ReliefOptions options_of_solver(const ForestOptions& options) {
  ReliefOptions relief;
  relief.hidden_weight = options.hidden_weight;
  relief.depth_order = options.depth_order;
  return relief;
}

Json percent(double share) { return std::min(100.0, 100 * share); }

bool wants_solids(const OperationCall& call) {
  for (const char* name : {"pillars.zip", "pillars.3mf", "forest.glb", "pictures.zip", "overview.png"})
    if (call.wants(name)) return true;
  return false;
}

void report_plan(Json& report, const ForestPlan& plan) {
  Json list = Json::array();
  for (std::size_t v = 0; v < plan.views.size(); ++v)
    list.push_back({{"model", plan.scene.viewpoints[v].model},
                    {"met_percent", percent(plan.walls.seen_share[v])},
                    {"own_percent", percent(plan.walls.used_share[v])}});
  report["in_plan"] = list;
  report["pillar_count"] = plan.scene.pillars.size();
}

void report_views(Json& report, std::vector<std::string>& notes, const ForestPlan& plan, const SolvedForest& forest) {
  Json list = Json::array();
  double seen_min = 1, intruding_max = 0;
  std::size_t pieces = 0;
  for (std::size_t v = 0; v < forest.checks.size(); ++v) {
    const ViewCheck& check = forest.checks[v];
    const ForestRelief& relief = forest.reliefs[v];
    const auto share = [&](int rays) { return percent(check.rays > 0 ? static_cast<double>(rays) / check.rays : 0); };
    list.push_back({{"model", plan.scene.viewpoints[v].model},
                    {"pieces", relief.pieces.size()},
                    {"seen_percent", share(check.seen)},
                    {"bare_percent", share(check.bare)},
                    {"no_pillar_percent", share(check.nothing)},
                    {"intrusion_percent", share(check.intruding)},
                    {"rays", check.rays},
                    {"normal_error_mean_deg_image", relief.relief.normal_error.mean_deg_image}});
    pieces += relief.pieces.size();
    seen_min = std::min(seen_min, check.seen_share());
    intruding_max = std::max(intruding_max, check.intruding_share());
    const std::string name = "Viewpoint " + std::to_string(v + 1) + " (" + plan.scene.viewpoints[v].model + ")";
    if (check.seen_share() < low_share)
      notes.push_back(
          name + " sees " + with_digits(100 * check.seen_share(), 3) + " % of its model: rays meet no pillar at " +
          with_digits(check.rays > 0 ? 100.0 * check.nothing / check.rays : 0, 3) + " % of it and a bare surface at " +
          with_digits(check.rays > 0 ? 100.0 * check.bare / check.rays : 0, 3) +
          " %. Move pillars into the gaps, or make them higher or wider.");
    if (relief.pieces_without_vertices > 0)
      notes.push_back(name + " leaves " + std::to_string(relief.pieces_without_vertices) +
                      " of its surfaces bare, because they are narrower than the triangles of its model: one with "
                      "more vertices would use them.");
  }
  report["viewpoints"] = list;
  report["seen_percent_min"] = percent(seen_min);
  report["intrusion_percent_max"] = percent(intruding_max);
  report["pieces"] = pieces;
}

void report_pillars(Json& report, std::vector<std::string>& notes, const SolvedForest& forest) {
  std::vector<int> pieces(forest.pillars.size(), 0);
  for (const auto& grids : forest.grids)
    for (const PieceGrid& grid : grids) pieces[static_cast<std::size_t>(grid.pillar)] += grid.any_covered();
  Json list = Json::array(), unused = Json::array();
  double volume_mm3 = 0;
  bool watertight = true;
  for (std::size_t p = 0; p < forest.pillars.size(); ++p) {
    const PillarSolid& pillar = forest.pillars[p];
    const Vec3 size = bounding_box(pillar.mesh).size();
    list.push_back({{"number", p + 1},
                    {"pin_mm", {pillar.pin_mm.x(), pillar.pin_mm.y()}},
                    {"size_mm", {size.x(), size.y(), size.z()}},
                    {"volume_ml", pillar.volume_mm3 / 1000},
                    {"pieces", pieces[p]}});
    if (pieces[p] == 0) unused.push_back(p + 1);
    volume_mm3 += pillar.volume_mm3;
    watertight = watertight && pillar.watertight;
  }
  report["pillars"] = list;
  report["unused_pillars"] = unused;
  report["watertight"] = watertight;
  report["volume_ml"] = volume_mm3 / 1000;
  if (!unused.empty())
    notes.push_back(std::to_string(unused.size()) + (unused.size() == 1 ? " pillar shows" : " pillars show") +
                    " no part of any model, and may still hide the others from elsewhere.");
}

OperationResult run_relief_forest(const OperationCall& call, const ForestOptions& given) {
  Context& context = call.context;
  const bool from_file = call.inputs.contains(scene_input);
  ForestOptions options = given;
  if (!from_file && options.layout == PillarLayout::scene) options.layout = PillarLayout::screens;
  const ForestInput input = [&] {
    // Where nothing is solved this is most of the work: a job learns from those before how its time is spent.
    const auto span = context.span(0, wants_solids(call) ? 0.1 : 0.9, "Reading the models");
    return read_forest(call, options);
  }();
  check_viewpoints(input.file.scene);
  std::vector<ViewFrame> frames;
  std::vector<const ViewFrame*> of_views;
  for (std::size_t v = 0; v < input.models.size(); ++v)
    frames.push_back(
        make_view_frame(input.models[v]->model.mesh,
                        ForestView(input.file.scene.viewpoints[v]).relief_options(options_of_solver(options))));
  for (const ViewFrame& frame : frames) of_views.push_back(&frame);
  const ForestPlan plan = plan_forest(input.file.scene, of_views, options, context);

  OperationResult result;
  Json& report = result.report;
  std::vector<std::string> notes, repairs;
  report_plan(report, plan);
  SolvedForest forest;
  // For files of the plan alone nothing is solved, so that they follow a pillar that is being dragged.
  if (wants_solids(call)) {
    const auto span = context.span(0.1, 0.9, "Solving the reliefs");
    const auto solver_of = [&](std::size_t v, Context& c) {
      return kept_solver(call, *input.models[v], plan.views[v].relief_options(options_of_solver(options)), c);
    };
    forest = solve_forest(plan, solver_of, options, context);
    report_views(report, notes, plan, forest);
    report_pillars(report, notes, forest);
  }

  context.progress(0.9, "Writing");
  Stopwatch watch;
  const double hole = options.pin_diameter_mm + options.pin_clearance_mm;
  const CutSheet floor = floor_plan(plan, hole);
  report["floor_size_mm"] = {floor.width_mm, floor.height_mm};
  report["hole_diameter_mm"] = hole;
  const auto add = [&](const char* name, const auto& make) {
    if (!call.wants(name)) return;
    for (const OutputInfo& info : forest_outputs())
      if (info.name == name) result.outputs.push_back(make_output(info, make()));
    context.check_cancelled();
  };
  add("pillars.zip", [&] { return pillar_files(forest, context); });
  add("pillars.3mf", [&] {
    WriteOptions write;
    write.object_per_group = true;
    write.name = "forest";
    return write_model(standing_pillars(forest), MeshFormat::three_mf, write, context);
  });
  add("forest.glb", [&] {
    Model model = standing_pillars(forest);
    // glTF's y is up.
    const Eigen::VectorXd y = model.mesh.V.col(1);
    model.mesh.V.col(1) = model.mesh.V.col(2);
    model.mesh.V.col(2) = -y;
    return write_model(model, MeshFormat::glb, context);
  });
  add("floor_plan.svg", [&] { return write_svg(floor); });
  add("floor_plan.dxf", [&] { return write_dxf(floor); });
  if (call.wants("pictures.zip") || call.wants("overview.png")) {
    const std::vector<Image> pictures = forest_pictures(plan, forest, options.picture_pixels, context);
    add("pictures.zip", [&] { return picture_files(plan, pictures, context); });
    add("overview.png", [&] { return write_png(overview(pictures), 0, context); });
  }
  add("models.zip", [&] {
    std::vector<const TriangleMesh*> meshes;
    for (const auto& loaded : input.models) meshes.push_back(&loaded->model.mesh);
    return model_picture_files(frames, meshes, context);
  });
  const auto json_bytes = [](const Json& json) {
    const std::string text = json.dump(1);
    const auto bytes = std::as_bytes(std::span(text));
    return Bytes(bytes.begin(), bytes.end());
  };
  add("scene.json", [&] { return json_bytes(forest_scene_json({plan.scene, input.file.models})); });
  add("plan.json", [&] { return json_bytes(plan_json(plan)); });
  report["seconds_read"] = input.seconds_read;
  report["seconds_solve"] = forest.seconds_solve;
  report["seconds_solids"] = forest.seconds_solids;
  report["seconds_check"] = forest.seconds_check;
  report["seconds_write"] = watch.seconds();
  for (const auto& model : input.models) repairs.insert(repairs.end(), model->repairs.begin(), model->repairs.end());
  report["repairs"] = repairs;
  report["notes"] = notes;
  return result;
}

}  // namespace

Operation relief_forest_operation() {
  Operation operation;
  operation.name = "relief-forest";
  operation.title = "Pillar forest";
  operation.summary =
      "Spreads several models over free-standing pillars: from its own viewpoint each lines up to the whole, from elsewhere all fall apart.";
  operation.inputs = forest_inputs();
  operation.outputs = forest_outputs();
  operation.report = forest_report_fields();
  take_options<ForestOptions>(operation, run_relief_forest);
  return operation;
}

}  // namespace formwright
