// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/operations/relief/relief_operation.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/format.h"
#include "geometry/mesh/adjacency.h"
#include "formats/mesh_io.h"
#include "formats/png/png16.h"
#include "job/contract/model_input.h"
#include "job/contract/operation_options.h"
#include "job/operations/relief/painting/painted_report.h"
#include "job/operations/relief/painting/painting_file.h"
#include "job/operations/relief/made_pieces.h"
#include "job/operations/relief/pieces/piece_files.h"
#include "job/operations/relief/relief_base.h"
#include "job/operations/relief/relief_declaration.h"
#include "job/operations/relief/solved_relief.h"
#include "job/operations/relief/thick_output.h"
#include "relief/height_map.h"
#include "relief/relief.h"
#include "relief/seen/seen_difference.h"

namespace formwright {
namespace {

constexpr double nodes_of_picture = 256;   // across the base where it is only looked at
constexpr double gap_worth_a_note = 1e-6;  // of the shape error: below, no eye and no gauge tells the difference
constexpr double unbounded_mm = 1e30;      // stands for "no bound" in relief.ply, where infinity has no safe spelling

Json vector_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

/// Across, upwards and towards the viewer from the middle of the plate's front, as a maker would hold it.
TriangleMesh plate_mesh(PlateSize plate, double plate_mm) {
  TriangleMesh box;
  const double x = plate.width_mm / 2, y = plate.height_mm / 2;
  box.V.resize(8, 3);
  for (int i = 0; i < 8; ++i) box.V.row(i) << (i & 1 ? x : -x), (i & 2 ? y : -y), (i & 4 ? -plate_mm : 0.0);
  box.F.resize(12, 3);
  box.F << 0, 1, 2, 1, 3, 2, 4, 6, 5, 5, 6, 7, 0, 4, 1, 1, 4, 5, 2, 3, 6, 3, 7, 6, 0, 2, 4, 2, 6, 4, 1, 5, 3, 3, 5, 7;
  return box;
}

/// The base in the same axes, for pictures only: coarser than the solid, and as deep as it may be carved behind the
/// relief.
TriangleMesh base_mesh(const ReliefSolver& solver, const Relief& relief, PlateSize plate, const ReliefOptions& options,
                       const AllowedSpace& space, Context& context) {
  if (space.base.is_flat() && space.below_mm == 0) return plate_mesh(plate, options.plate_mm);
  const double pixel_mm = std::max(options.pixel_mm, std::max(plate.width_mm, plate.height_mm) / nodes_of_picture);
  const HeightMap bed = make_bed_map(covering(solver, relief), options.width_mm, plate, pixel_mm, space, context);
  TriangleMesh mesh = make_solid(bed, options.plate_mm, solid_tolerance_share * (bed.top_mm - bed.floor_mm), context);
  mesh.V.rowwise() -= Eigen::RowVector3d(plate.width_mm / 2, plate.height_mm / 2, options.plate_mm - bed.floor_mm);
  return mesh;
}

/// The deformed model on its base, in the same axes.
Model display_model(const ReliefSolver& solver, const Relief& relief, const TriangleMesh& base, double size_mm) {
  const CoveringMesh front = covering(solver, relief);
  const Eigen::Index n = front.V.rows(), m = front.F.rows();
  Model model;
  model.mesh.V.resize(n + base.V.rows(), 3);
  model.mesh.V.topRows(n) = front.V * size_mm;
  model.mesh.V.topRows(n).col(2) *= -1;
  model.mesh.V.bottomRows(base.V.rows()) = base.V;
  model.mesh.F.resize(m + base.F.rows(), 3);
  model.mesh.F.topRows(m) = front.F;
  model.mesh.F.bottomRows(base.F.rows()) = base.F.array() + static_cast<int>(n);
  return model;
}

std::vector<VertexColumn> ply_columns(const SolvedRelief& solved, const ReliefOptions& options) {
  const ReliefSolver& solver = *solved.solver;
  const Relief& relief = solved.relief;
  const Eigen::Index n = relief.u.size();
  Eigen::VectorXd visible(n);
  for (Eigen::Index i = 0; i < n; ++i) visible[i] = solver.visibility().vertex[static_cast<std::size_t>(i)];
  std::vector<VertexColumn> columns{{"lambda", relief.lambda_mm, ColumnKind::float64},
                                    {"lambda_min", relief.lambda_min_mm, ColumnKind::float64},
                                    {"lambda_max", relief.lambda_max_mm.cwiseMin(unbounded_mm), ColumnKind::float64},
                                    {"visible", visible, ColumnKind::uint8},
                                    {"normal_error_deg", relief.normal_error.vertex_deg, ColumnKind::float64}};
  for (VertexColumn& painted :
       columns_of_painting(solved.painted.painting, options.thickness_mm, options.carve_depth_mm))
    columns.push_back(std::move(painted));
  return columns;
}

void report_relief(Json& report, const LoadedModel& loaded, const ReliefSolver& solver, const Relief& relief,
                   const ReliefOptions& options) {
  const ViewFrame& frame = solver.frame();
  report["vertices"] = loaded.model.mesh.vertex_count();
  report["faces"] = loaded.model.mesh.face_count();
  report["visible_vertices"] = solver.visibility().visible_vertices;
  report["energy"] = relief.energy;
  report["energy_linear"] = relief.energy_linear;
  report["normal_error_mean_deg"] = relief.normal_error.mean_deg;
  report["normal_error_linear_mean_deg"] = relief.normal_error_linear.mean_deg;
  report["normal_error_mean_deg_image"] = relief.normal_error.mean_deg_image;
  report["normal_error_linear_mean_deg_image"] = relief.normal_error_linear.mean_deg_image;
  report["bound_violation_max_mm"] = relief.bound_violation_max_mm;
  report["order_violation_max_mm"] = relief.order_violation_max_mm;
  report["order_rows"] = relief.order_rows;
  report["order_rows_left_out"] = relief.order_rows_left_out;
  report["vertices_beyond_base"] = relief.vertices_beyond_base;
  report["kkt_residual"] = relief.qp.kkt_residual;
  report["relative_gap"] = relief.qp.relative_gap;
  report["rounds"] = relief.qp.rounds;
  report["balanced_steps"] = relief.balanced_steps;
  report["active_constraints"] = relief.qp.active_constraints;
  report["method_used"] = EnumNames<QpMethod>::names.at(static_cast<std::size_t>(relief.qp.method_used));
  const double size = options.width_mm;
  report["scale_mm_per_unit"] = frame.scale * size;
  const bool straight = frame.kappa == 0;
  const Vec3 viewpoint(0, 0, straight ? frame.P.col(2).minCoeff() - 1 : -1 / frame.kappa);
  report["viewpoint_mm"] = vector_json(frame.to_model(viewpoint, size));
  report["direction"] = vector_json(frame.axes.row(2).transpose());
  report["right"] = vector_json(frame.axes.row(0).transpose());
  report["up"] = vector_json(frame.axes.row(1).transpose());
  report["plate_centre_mm"] = vector_json(frame.to_model(Vec3(0, 0, 0), size));
  report["distance_mm"] = straight ? Json(nullptr) : Json(size / frame.kappa);
}

void report_pictures(Json& report, const ReliefSolver& solver, const Relief& relief, Context& context) {
  const SeenComparison comparison(solver.frame(), solver.F(), 1, context);
  const SeenDifference ours = comparison.with(relief.seen, context),
                       plain = comparison.with(relief.seen_linear, context);
  report["picture_similarity"] = ours.similarity;
  report["picture_similarity_linear"] = plain.similarity;
  report["false_edges_percent"] = ours.false_edges_percent;
  report["false_edges_linear_percent"] = plain.false_edges_percent;
}

/// What the maker should know about how the relief was found.
std::vector<std::string> notes_of(const Relief& relief) {
  std::vector<std::string> notes;
  const BoundedQpSolution& qp = relief.qp;
  if (qp.relative_gap > gap_worth_a_note) {
    notes.push_back(
        "The relief is not quite the best one: the solver reached its limit of work. Its shape error is at most " +
        with_digits(100 * qp.relative_gap, 2) +
        " % above the smallest possible one. A thicker relief or a simpler model is solved completely.");
  }
  if (const int left_out = relief.order_rows_left_out; left_out > 0) {
    notes.push_back("Parts may lie the wrong way round in depth at " + std::to_string(left_out) +
                    (left_out == 1 ? " place" : " places") +
                    ": between the bounds of this base there is no room to keep their order. More thickness or another "
                    "viewpoint gives them room.");
  }
  if (const int beyond = relief.vertices_beyond_base; beyond > 0) {
    notes.push_back("The model reaches beyond the base: " + std::to_string(beyond) +
                    (beyond == 1 ? " vertex has" : " vertices have") +
                    " nothing behind, and may lie at any depth. Make the relief smaller or the base larger.");
  }
  return notes;
}

/// A job that asks for all files gets those that there are. One that asks for nothing but pieces is refused where there
/// are none.
void check_pieces(const OperationCall& call, bool in_pieces) {
  if (in_pieces || !wants_pieces(call)) return;
  for (const OutputInfo& info : relief_outputs())
    if (call.wants(info.name)) return;
  throw Error(ErrorCode::invalid_input, "base",
              "This base is one piece: choose stairs or strips as its shape, give a file of several parts, or ask for "
              "other files.");
}

OperationResult run_relief(const OperationCall& call, const ReliefOptions& options) {
  Context& context = call.context;
  const bool may_have_pieces = options.base == BaseShape::stairs || options.base == BaseShape::strips ||
                               call.inputs.contains(base_input_info().name);
  check_pieces(call, may_have_pieces);
  check_thick_surface(call, options);
  const SolvedRelief solved = [&] {
    const auto span = context.span(0, 0.9, "Reading the model");
    return solve_relief(call, options);
  }();
  const std::shared_ptr<const LoadedModel>& loaded = solved.loaded;
  const std::shared_ptr<ReliefSolver>& solver = solved.solver;
  const Relief& relief = solved.relief;
  check_pieces(call, has_pieces(solved));
  Stopwatch watch;

  context.progress(0.9, "Writing");
  OperationResult result;
  std::vector<std::string> notes = notes_of(relief);
  Json& report = result.report;
  report_relief(report, *loaded, *solver, relief, options);
  report["factor_reused"] = solved.reused;
  if (options.compare_pictures) report_pictures(report, *solver, relief, context);

  const ViewFrame& frame = solver->frame();
  const PlateSize plate = plate_of(frame, options);
  const AllowedSpace space = allowed_space(solved, options);
  const auto base_depth =
      solved.base.depth_range(0.5 * plate.width_mm / options.width_mm, 0.5 * plate.height_mm / options.width_mm)
          .value_or(std::pair{0.0, 0.0});
  const double range_mm = options.width_mm * (base_depth.second - base_depth.first) +
                          solved.base.max_along_z() * (space.above_mm + space.below_mm);
  if (solved.base_from_file) report["base_parts"] = solved.base.parts() != nullptr ? solved.base.parts()->count() : 1;
  std::ranges::move(notes_on_parts(solved), std::back_inserter(notes));
  const Painting& painting = solved.painted.painting;
  if (!painting.empty()) report["painted_vertices"] = painted_vertices(painting);
  if (!painting.empty() || options.only_outline) report["stands_out_max_mm"] = space.above_mm;
  report["size_mm"] = {plate.width_mm, plate.height_mm, options.plate_mm + range_mm};
  const auto add = [&](const char* name, Bytes bytes) {
    for (const OutputInfo& info : relief_outputs())
      if (info.name == name) result.outputs.push_back(make_output(info, std::move(bytes)));
    context.check_cancelled();
  };
  if (call.wants("relief.ply")) {
    const CoveringMesh front = covering(*solver, relief);
    Model model;
    model.mesh = {frame.to_model(front.V, options.width_mm), front.F};
    std::vector<VertexColumn> columns = ply_columns(solved, options);
    if (front.band != nullptr)
      for (VertexColumn& column : columns) column.values = column.values(relief.pieces.origin).eval();
    WriteOptions write;
    write.columns = columns;
    add("relief.ply", write_model(model, MeshFormat::ply, write, context));
  }
  if (call.wants("relief.glb") || call.wants("base.ply")) {
    Model drawn;
    drawn.mesh = base_mesh(*solver, relief, plate, options, space, context);
    if (call.wants("relief.glb"))
      add("relief.glb",
          write_model(display_model(*solver, relief, drawn.mesh, options.width_mm), MeshFormat::glb, context));
    if (call.wants("base.ply")) {
      Positions in_view = drawn.mesh.V / options.width_mm;
      in_view.col(2) *= -1;
      drawn.mesh.V = frame.to_model(in_view, options.width_mm);
      add("base.ply", write_model(drawn, MeshFormat::ply, context));
    }
  }
  if (call.wants("base.obj")) {
    const Positions no_vertices(0, 3);
    const Triangles no_faces(0, 3);
    const HeightMap bare =
        make_height_map({no_vertices, no_faces}, options.width_mm, plate, options.pixel_mm, space, context);
    Model base;
    base.mesh = make_solid(bare, options.plate_mm, solid_tolerance_share * options.thickness_mm, context);
    add("base.obj", write_model(base, MeshFormat::obj, context));
  }
  const bool wants_solid = call.wants("relief.stl") || call.wants("relief.3mf") || call.wants("relief.obj");
  const bool thick = options.solid == SolidKind::thick;
  HeightMap map;
  if ((wants_solid && !thick) || call.wants("heightmap.png"))
    map = make_height_map(covering(*solver, relief), options.width_mm, plate, options.pixel_mm, space, context);
  if (call.wants("heightmap.png")) {
    report["heightmap_pixel_mm"] = {map.pitch_x_mm, map.pitch_y_mm};
    const double of_map_mm = map.top_mm - map.floor_mm;
    report["heightmap_mm_per_level"] = of_map_mm / 65535;
    report["heightmap_floor_mm"] = map.floor_mm;
    Grey16Image image;
    image.width = map.columns;
    image.height = map.rows;
    image.pixel_width_mm = map.pitch_x_mm;
    image.pixel_height_mm = map.pitch_y_mm;
    image.levels.reserve(map.height_mm.size());
    for (int row = map.rows - 1; row >= 0; --row)  // pictures start at the top
      for (int column = 0; column < map.columns; ++column)
        image.levels.push_back(static_cast<std::uint16_t>(
            std::lround(std::min(1.0, (static_cast<double>(map.at(row, column)) - map.floor_mm) / of_map_mm) * 65535)));
    add("heightmap.png", write_png16(image));
  }
  if (wants_solid) {
    Model solid;
    if (thick) {
      const auto span = context.span(0.9, 1, "Making the solid");
      solid.mesh = thick_mesh(solved, options, plate, space, report, notes, context);
    } else {
      solid.mesh = make_solid(map, options.plate_mm, solid_tolerance_share * options.thickness_mm, context);
    }
    report["watertight"] = Adjacency(solid.mesh).is_closed();
    for (const char* name : {"relief.stl", "relief.3mf", "relief.obj"})
      if (call.wants(name)) add(name, write_model(solid, *mesh_format_of_extension(name), context));
  }
  if (wants_pieces(call)) {
    const auto span = context.span(0.9, 1, "Making the pieces");
    add_pieces(call, solved, options, result);
  }
  report["seconds_read"] = loaded->seconds_read + loaded->seconds_repair;
  report["seconds_setup"] = solved.reused ? 0.0 : solver->seconds_setup();
  report["seconds_solve"] = solved.seconds_solve + (solved.reused ? 0.0 : solver->seconds_factorise());
  report["seconds_factorise"] = solved.reused ? 0.0 : solver->seconds_factorise();
  report["seconds_write"] = watch.seconds();
  report["repairs"] = loaded->repairs;
  notes.insert(notes.end(), solved.painted.notes.begin(), solved.painted.notes.end());
  report["notes"] = notes;
  return result;
}

}  // namespace

Operation relief_operation() {
  Operation operation;
  operation.name = "relief";
  operation.title = "Relief";
  operation.summary = "Turns a model into a thin relief that still looks deep from the viewpoint you choose.";
  operation.inputs = {model_input_info(), base_input_info(), painting_input_info(), painted_mesh_input_info()};
  operation.outputs = relief_outputs();
  std::ranges::move(piece_outputs(), std::back_inserter(operation.outputs));
  operation.report = relief_report_fields();
  std::ranges::move(piece_report_fields(), std::back_inserter(operation.report));
  take_options<ReliefOptions>(operation, run_relief);
  return operation;
}

}  // namespace formwright
