// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/mould/mould.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "base/error.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/measures.h"
#include "thermoform/mould/solid_shapes.h"

namespace formwright {
namespace {

constexpr double snap_mm = 1e-6;        // placing rotates flat undersides by about 1e-14 mm
constexpr double sink_step_mm = 1e-3;   // deeper, where the model touches the plate in points or lines
constexpr double min_opening_mm2 = 20;  // a funnel of 5 mm
constexpr double automatic_foot_mm = 1;
constexpr double plaster_density_g_per_ml = 2.63;  // calcium sulphate hemihydrate
constexpr int vent_sides = 12, outline_sides = 24;

std::string millimetres(double value) { return with_digits(value, 3) + " mm"; }

/// Whether a block around the model would be a manifold where the model meets the plate: around every vertex at z = 0,
/// what rises above the plate is one fan, and leaves room for a flat face or goes on below.
bool stands_cleanly(const TriangleMesh& mesh, const Adjacency& adjacency) {
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    if (mesh.V(v, 2) != 0) continue;
    const auto outgoing = adjacency.outgoing(v);
    int rising_edges = 0, ends_of_rise = 0, lower_or_flat = 0;
    for (const int h : outgoing) {
      const double z = mesh.V(adjacency.to(h), 2), next = mesh.V(adjacency.from(previous_halfedge(h)), 2);
      if (z > 0) ++rising_edges;
      if (z > 0 && next <= 0) ++ends_of_rise;
      if (z <= 0 && next <= 0) ++lower_or_flat;  // a face at or below the plate
      if (z > 0 && next < 0) ++lower_or_flat;    // passes through the plate
      if (z < 0 && next > 0) ++lower_or_flat;
    }
    if (rising_edges > 0 && !adjacency.is_boundary_vertex(v) && (ends_of_rise != 1 || lower_or_flat == 0)) return false;
  }
  return true;
}

}  // namespace

TriangleMesh ready_for_plate(const TriangleMesh& placed, std::vector<std::string>& notes) {
  TriangleMesh mesh = placed;
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i)
    if (std::abs(mesh.V(i, 2)) < snap_mm) mesh.V(i, 2) = 0;
  const Adjacency adjacency(mesh);
  for (int attempt = 0; attempt < 4 && !stands_cleanly(mesh, adjacency); ++attempt) {
    mesh.V.col(2).array() -= sink_step_mm;
    for (Eigen::Index i = 0; i < mesh.V.rows(); ++i)
      if (std::abs(mesh.V(i, 2)) < snap_mm) mesh.V(i, 2) = 0;
  }
  const double top = mesh.V.rows() > 0 ? mesh.V.col(2).maxCoeff() : 0;
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> faces;
  double highest = 0;
  for (const auto& loop : boundary_loops(adjacency)) {
    double loop_top = mesh.V(loop.front(), 2);
    for (const int v : loop) loop_top = std::max(loop_top, mesh.V(v, 2));
    if (loop_top <= 0 || loop_top > top / 2) continue;  // cut away in any case, or not an underside
    highest = std::max(highest, loop_top);
    const auto first = static_cast<int>(mesh.V.rows()) + static_cast<int>(points.size()),
               size = static_cast<int>(loop.size());
    for (int i = 0; i < size; ++i) {
      const int a = loop[static_cast<std::size_t>(i)], b = loop[static_cast<std::size_t>((i + 1) % size)],
                next = (i + 1) % size;
      points.emplace_back(mesh.V(a, 0), mesh.V(a, 1), std::min(mesh.V(a, 2), 0.0) - 1);
      faces.push_back({b, a, first + i});
      faces.push_back({b, first + i, first + next});
    }
  }
  if (points.empty()) return mesh;
  notes.push_back("The model is open below: its edge, up to " + millimetres(highest) +
                  " above the plate, was drawn straight down to close it.");
  TriangleMesh closed{Positions(mesh.V.rows() + static_cast<Eigen::Index>(points.size()), 3),
                      Triangles(mesh.F.rows() + static_cast<Eigen::Index>(faces.size()), 3)};
  closed.V.topRows(mesh.V.rows()) = mesh.V;
  closed.F.topRows(mesh.F.rows()) = mesh.F;
  for (std::size_t i = 0; i < points.size(); ++i)
    closed.V.row(mesh.V.rows() + static_cast<Eigen::Index>(i)) = points[i];
  for (std::size_t i = 0; i < faces.size(); ++i)
    closed.F.row(mesh.F.rows() + static_cast<Eigen::Index>(i)) << faces[i][0], faces[i][1], faces[i][2];
  return closed;
}

double base_area_mm2(const TriangleMesh& solid, double height_mm) {
  double area = 0;
  for (Eigen::Index f = 0; f < solid.F.rows(); ++f) {
    const Vec3 a = solid.V.row(solid.F(f, 0)), b = solid.V.row(solid.F(f, 1)), c = solid.V.row(solid.F(f, 2));
    if (a.z() == height_mm && b.z() == height_mm && c.z() == height_mm) area -= 0.5 * (b - a).cross(c - a).z();
  }
  return area;
}

ExactSolid model_on_plate(const TriangleMesh& placed, const ThermoformMouldOptions& options,
                          std::vector<std::string>& notes, Context& context) {
  ExactSolid model;
  {
    const auto span = context.span(0, 0.7, "Cutting the model at the plate");
    model = ExactSolid::above(ready_for_plate(placed, notes), 0, "mould", context);
  }
  if (model.empty())
    throw Error(ErrorCode::invalid_input, "sink_mm",
                "Nothing of the model stands above the plate: lower it less into the plate (sink_mm).");
  double foot_mm = options.foot_mm.value_or(0);
  double area = base_area_mm2(model.mesh(), 0);
  if (!options.foot_mm && area < min_opening_mm2) foot_mm = automatic_foot_mm;
  if (foot_mm > 0) {
    const auto span = context.span(0.7, 1, "Straightening the foot");
    const double height = bounding_box(model.mesh()).size().z();
    ExactSolid footed;
    double widened = 0;
    for (;; foot_mm *= 1.5) {
      footed = unite(model, model.section_prism(foot_mm, 0, context), context);
      widened = base_area_mm2(footed.mesh(), 0);
      if (options.foot_mm || widened >= 2 * min_opening_mm2 || foot_mm > height / 8) break;
    }
    model = footed;
    if (!options.foot_mm)
      notes.push_back("The model touches the plate with " + std::to_string(std::lround(area)) + " mm2 only: below " +
                      millimetres(foot_mm) + " its walls were drawn straight down, to " +
                      std::to_string(std::lround(widened)) + " mm2.");
    area = widened;
  }
  if (area < min_opening_mm2)
    throw Error(
        ErrorCode::invalid_input, "sink_mm",
        "The model touches the plate with " + std::to_string(std::lround(area)) +
            " mm2 only, too little to stand on or to pour through: sink it (sink_mm), or widen its foot (foot_mm).");
  return model;
}

Mould make_mould(const ExactSolid& model, const std::vector<Vent>& vents, const ThermoformMouldOptions& options,
                 Context& context) {
  Mould mould;
  mould.body = model;
  const TriangleMesh shape = model.mesh();
  const BoundingBox box = bounding_box(shape);
  if (options.base_mm > 0) {
    const auto span = context.span(0, 0.3, "Adding the base plate");
    const Vec3 rim(options.base_rim_mm, options.base_rim_mm, 0);
    const Vec3 lower = box.lower - rim, upper = box.upper + rim;
    // A whole micrometre of rim at least: plates that end exactly below the model's widest edges would touch them in
    // lines.
    const double minimum = 1e-3;
    const TriangleMesh plate = box_mesh({lower.x() - minimum, lower.y() - minimum, -options.base_mm},
                                        {upper.x() + minimum, upper.y() + minimum, 0});
    mould.body = unite(mould.body, ExactSolid::from_mesh(plate, "base_mm", context), context);
  }
  if (!vents.empty()) {
    const auto span = context.span(0.3, 0.6, "Drilling vents");
    const double radius = options.vent_diameter_mm / 2;
    std::vector<TriangleMesh> drills;
    for (const Vent& vent : vents)
      drills.push_back(turned_mesh(
          {vent.position_mm.x(), vent.position_mm.y(), 0}, 2,
          {{-options.base_mm - 1, radius}, {vent.position_mm.z() + options.vent_diameter_mm, radius}}, vent_sides));
    mould.body = subtract(mould.body, ExactSolid::from_mesh(collected(drills), "vents", context), context);
  }
  mould.solid = mould.body;
  if (options.kind == MouldKind::negative) {
    const auto span = context.span(0.6, 1, "Cutting the model out of the block");
    const TriangleMesh body = mould.body.mesh();
    const BoundingBox around = bounding_box(body);
    const double top = around.upper.z() + options.wall_mm;
    TriangleMesh block;
    if (options.outline == MouldOutline::box) {
      const Vec3 wall(options.wall_mm, options.wall_mm, 0);
      block = box_mesh(around.lower - wall, {around.upper.x() + wall.x(), around.upper.y() + wall.y(), top});
    } else {
      std::vector<Vec2> points;
      for (Eigen::Index i = 0; i < body.V.rows(); ++i) points.emplace_back(body.V(i, 0), body.V(i, 1));
      block = vertical_prism(widened_outline(convex_outline(std::move(points)), options.wall_mm, outline_sides),
                             around.lower.z(), top);
    }
    mould.solid = subtract(ExactSolid::from_mesh(block, "wall_mm", context), mould.body, context);
  }
  return mould;
}

Mixture plaster_mixture(double volume_ml, double water_to_plaster_ratio) {
  const double plaster_g = volume_ml / (1 / plaster_density_g_per_ml + water_to_plaster_ratio);
  return {plaster_g, water_to_plaster_ratio * plaster_g};
}

}  // namespace formwright
