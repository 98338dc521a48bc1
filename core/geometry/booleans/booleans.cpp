// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/booleans/booleans.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <string>
#include <tuple>

#include "base/format.h"
#include "base/error.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/booleans/booleans_surface.h"
#include "geometry/mesh/measures.h"

namespace formwright {
namespace {

namespace processing = CGAL::Polygon_mesh_processing;
using ExactMesh = CGAL::Surface_mesh<ExactPoint>;

/// CGAL's hooks, for progress and cancel. Copied about by CGAL, so it only points to things.
struct Watcher : processing::Corefinement::Default_visitor<ExactMesh> {
  explicit Watcher(Context& watched) : context(&watched) {}
  void progress_filtering_intersections(double fraction) const { context->progress(0.5 * fraction); }
  void before_subface_creations(ExactMesh::Face_index, ExactMesh&) { context->check_cancelled(); }
  void triangulating_faces_step() const { context->check_cancelled(); }
  void intersection_of_coplanar_faces_step() const { context->check_cancelled(); }
  void edge_face_intersections_step() const { context->check_cancelled(); }
  void start_building_output() const { context->progress(0.8); }
  void before_face_copy(ExactMesh::Face_index face, const ExactMesh&, ExactMesh&) const {
    if (static_cast<unsigned>(face) % 4096 == 0) context->check_cancelled();
  }
  Context* context;
};

template <class Mesh, class Points, class Faces>
Mesh cgal_mesh(const Points& points, const Faces& faces, std::size_t point_count, std::size_t face_count) {
  Mesh mesh;
  mesh.reserve(static_cast<typename Mesh::size_type>(point_count),
               static_cast<typename Mesh::size_type>(face_count * 3 / 2),
               static_cast<typename Mesh::size_type>(face_count));
  using Vertex = typename Mesh::Vertex_index;
  for (std::size_t i = 0; i < point_count; ++i) mesh.add_vertex(points(i));
  for (std::size_t f = 0; f < face_count; ++f) {
    const auto [a, b, c] = faces(f);
    using Index = typename Mesh::size_type;
    mesh.add_face(Vertex(static_cast<Index>(a)), Vertex(static_cast<Index>(b)), Vertex(static_cast<Index>(c)));
  }
  return mesh;
}

ExactMesh to_cgal(const ExactSurface& surface) {
  ExactMesh mesh = cgal_mesh<ExactMesh>([&](std::size_t i) { return surface.points[i]; },
                                        [&](std::size_t f) { return surface.faces[f]; }, surface.points.size(),
                                        surface.faces.size());
  if (mesh.number_of_faces() != surface.faces.size())
    throw Error(ErrorCode::internal, "",
                "A solid was no longer closed between two operations: this is a bug in Formwright.");
  return mesh;
}

/// Points and faces in an order of their own: CGAL's depends on hashes, which are other ones in WASM.
ExactSolid from_cgal(const ExactMesh& mesh) {
  auto surface = std::make_shared<ExactSurface>();
  std::vector<ExactMesh::Vertex_index> order(mesh.vertices().begin(), mesh.vertices().end());
  std::ranges::stable_sort(order, [&](const auto v, const auto w) { return mesh.point(v) < mesh.point(w); });
  std::vector<int> index(mesh.num_vertices(), -1);
  for (const auto v : order) {
    index[v.idx()] = static_cast<int>(surface->points.size());
    surface->points.push_back(mesh.point(v));
  }
  for (const auto f : mesh.faces()) {
    std::array<int, 3> face{};
    std::size_t k = 0;
    for (const auto v : mesh.vertices_around_face(mesh.halfedge(f))) face.at(k++) = index[v.idx()];
    std::ranges::rotate(face, std::ranges::min_element(face));
    surface->faces.push_back(face);
  }
  std::ranges::sort(surface->faces);
  if (surface->faces.empty()) return {};
  return ExactSolid(surface);
}

enum class Boolean { unite, subtract, intersect };

ExactSolid boolean(const ExactSolid& a, const ExactSolid& b, Boolean kind, Context& context) {
  context.check_cancelled();
  if (a.empty() || b.empty()) {
    if (kind == Boolean::unite) return a.empty() ? b : a;
    return kind == Boolean::subtract ? a : ExactSolid();
  }
  ExactMesh first = to_cgal(a.surface()), second = to_cgal(b.surface()), result;
  const auto watched = CGAL::parameters::visitor(Watcher(context));
  bool manifold = false;
  switch (kind) {
    case Boolean::unite: manifold = processing::corefine_and_compute_union(first, second, result, watched); break;
    case Boolean::subtract:
      manifold = processing::corefine_and_compute_difference(first, second, result, watched);
      break;
    case Boolean::intersect:
      manifold = processing::corefine_and_compute_intersection(first, second, result, watched);
      break;
  }
  const ExactSolid solid = manifold ? from_cgal(result) : ExactSolid();
  // CGAL keeps two edges between the same vertices apart; a file of triangles cannot.
  if (!manifold || !edges_manifold(solid.surface()))
    throw Error(ErrorCode::could_not_solve, "",
                "The parts touch each other along an edge or at a point only, which no printable solid may: move the "
                "model by a fraction of a millimetre (sink_mm or turn_deg).");
  return solid;
}

std::string millimetres(double value) { return with_digits(value, 3) + " mm"; }

/// The part of the mesh whose faces are in component `part`, vertices and all.
TriangleMesh component(const TriangleMesh& mesh, const Components& parts, int part) {
  TriangleMesh result{mesh.V, Triangles(mesh.F.rows(), 3)};
  int count = 0;
  for (int f = 0; f < mesh.face_count(); ++f)
    if (parts.of[static_cast<std::size_t>(f)] == part) result.F.row(count++) = mesh.F.row(f);
  result.F.conservativeResize(count, 3);
  return result;
}

ExactSolid capped_above(const TriangleMesh& mesh, double height_mm, std::string_view where, Context& context) {
  auto surface = std::make_shared<ExactSurface>(clipped(exact_surface(mesh), 2, height_mm, true, context));
  if (surface->faces.empty()) return {};
  const auto border = border_edges(*surface);
  double highest = height_mm;
  for (const auto& edge : border)
    for (const int i : edge)
      highest = std::max(highest, CGAL::to_double(surface->points[static_cast<std::size_t>(i)].z()));
  if (highest > height_mm)
    throw Error(ErrorCode::invalid_input, std::string(where),
                "The model has a hole up to " + millimetres(highest - height_mm) +
                    " above the base plate: repair it or fill its holes, or sink it (sink_mm) until the hole is below "
                    "the plate; a mould needs a watertight model, the simulation does not.");
  for (const auto& [a, b, c] : planar_filling(surface->points, border, 2)) surface->faces.push_back({a, c, b});
  separate_fans(*surface);
  if (!border_edges(*surface).empty())
    throw Error(ErrorCode::invalid_input, std::string(where),
                "The model's outline on the base plate crosses itself: repair the model, or change sink_mm.");
  const ExactSolid solid(surface);
  if (!(solid.volume_mm3() > 0))
    throw Error(ErrorCode::invalid_input, std::string(where),
                "The model is inside out: turn its faces around in a modeller, or repair it.");
  return solid;
}

}  // namespace

ExactSurface exact_surface(const TriangleMesh& mesh) {
  ExactSurface surface;
  surface.points.reserve(static_cast<std::size_t>(mesh.V.rows()));
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i)
    surface.points.emplace_back(mesh.V(i, 0), mesh.V(i, 1), mesh.V(i, 2));
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) surface.faces.push_back({mesh.F(f, 0), mesh.F(f, 1), mesh.F(f, 2)});
  return surface;
}

TriangleMesh rounded(const ExactSurface& surface) {
  TriangleMesh mesh;
  mesh.V.resize(static_cast<Eigen::Index>(surface.points.size()), 3);
  mesh.F.resize(static_cast<Eigen::Index>(surface.faces.size()), 3);
  for (std::size_t i = 0; i < surface.points.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      // Given points have intervals of one number; others are wider by some bits that depend on the platform.
      const auto& x = surface.points[i][k];
      const auto& interval = CGAL::approx(x);
      mesh.V(static_cast<Eigen::Index>(i), k) = interval.is_point() ? interval.inf() : CGAL::to_double(CGAL::exact(x));
    }
  for (std::size_t f = 0; f < surface.faces.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k)
      mesh.F(static_cast<Eigen::Index>(f), static_cast<Eigen::Index>(k)) = surface.faces[f][k];
  return mesh;
}

bool parts_overlap(const TriangleMesh& mesh, double height_mm, std::string_view where, Context& context) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
  context.check_cancelled();
  std::vector<int> kept;
  for (int f = 0; f < mesh.face_count(); ++f)
    if (std::max({mesh.V(mesh.F(f, 0), 2), mesh.V(mesh.F(f, 1), 2), mesh.V(mesh.F(f, 2), 2)}) > height_mm)
      kept.push_back(f);
  const Mesh checked = cgal_mesh<Mesh>(
      [&](std::size_t i) {
        const auto v = mesh.V.row(static_cast<Eigen::Index>(i));
        return Kernel::Point_3(v[0], v[1], v[2]);
      },
      [&](std::size_t i) {
        const int f = kept[i];
        return std::array{mesh.F(f, 0), mesh.F(f, 1), mesh.F(f, 2)};
      },
      static_cast<std::size_t>(mesh.V.rows()), kept.size());
  if (checked.number_of_faces() != kept.size())
    throw Error(ErrorCode::invalid_input, std::string(where),
                "The model is not a manifold: repair it; a mould needs a watertight model, the simulation does not.");
  std::vector<std::pair<Mesh::Face_index, Mesh::Face_index>> pairs;
  processing::self_intersections(checked, std::back_inserter(pairs));
  context.check_cancelled();
  if (pairs.empty()) return false;
  const Components parts = face_components(Adjacency(mesh));
  const auto face = [&](Mesh::Face_index f) { return kept[f.idx()]; };
  std::size_t own = 0;
  int example = face(pairs.front().first);
  for (const auto& [a, b] : pairs)
    if (parts.of[static_cast<std::size_t>(face(a))] == parts.of[static_cast<std::size_t>(face(b))]) {
      if (own++ == 0) example = face(a);
    }
  if (own == 0) return true;
  const auto p = mesh.V.row(mesh.F(example, 0));
  throw Error(
      ErrorCode::invalid_input, std::string(where),
      "The model crosses itself at " + std::to_string(own) + (own == 1 ? " place" : " places") + ", such as x " +
          millimetres(p[0]) + ", y " + millimetres(p[1]) + ", z " + millimetres(p[2]) +
          " on the machine: repair or remesh it in a modeller; a mould needs a sound solid, the simulation does not.");
}

ExactSolid ExactSolid::from_mesh(const TriangleMesh& mesh, std::string_view where, Context& context) {
  const Adjacency adjacency(mesh);
  if (!adjacency.is_closed())
    throw Error(ErrorCode::invalid_input, std::string(where),
                "The model is not closed: repair it or fill its holes; a mould needs a watertight model, the "
                "simulation does not.");
  const double lowest = mesh.V.rows() > 0 ? mesh.V.col(2).minCoeff() : 0;
  const double below = lowest - 1 - std::abs(lowest);
  return above(mesh, below, where, context);
}

ExactSolid ExactSolid::above(const TriangleMesh& mesh, double height_mm, std::string_view where, Context& context) {
  if (!parts_overlap(mesh, height_mm, where, context)) {
    const ExactSolid solid = capped_above(mesh, height_mm, where, context);
    if (!solid.empty() && face_components(Adjacency(mesh)).count > 1) {
      const ExactMesh bounding = to_cgal(solid.surface());
      if (!processing::does_bound_a_volume(bounding))
        throw Error(ErrorCode::invalid_input, std::string(where),
                    "One part of the model lies within another as a second solid: remove the inner one, or turn its "
                    "faces around if it is meant as a cavity.");
    }
    return solid;
  }
  // Sound parts that overlap, such as eyes stuck into a head: one after the other.
  const Components parts = face_components(Adjacency(mesh));
  ExactSolid whole;
  for (int part = 0; part < parts.count; ++part) {
    const auto span =
        context.span(static_cast<double>(part) / parts.count, (part + 1.0) / parts.count, "Joining overlapping parts");
    whole = unite(whole, capped_above(component(mesh, parts, part), height_mm, where, context), context);
  }
  return whole;
}

bool ExactSolid::empty() const { return surface_ == nullptr || surface_->faces.empty(); }

int ExactSolid::face_count() const { return empty() ? 0 : static_cast<int>(surface_->faces.size()); }

const ExactSolid::Surface& ExactSolid::surface() const {
  static const Surface nothing;
  return surface_ ? *surface_ : nothing;
}

TriangleMesh ExactSolid::mesh() const {
  TriangleMesh result = rounded(surface());
  if (!empty() && !Adjacency(result).is_closed())
    throw Error(ErrorCode::internal, "", "The exact solid is not closed.");
  return result;
}

double ExactSolid::volume_mm3() const { return empty() ? 0 : signed_volume(rounded(surface())); }

ExactSolid unite(const ExactSolid& a, const ExactSolid& b, Context& context) {
  return boolean(a, b, Boolean::unite, context);
}
ExactSolid subtract(const ExactSolid& a, const ExactSolid& b, Context& context) {
  return boolean(a, b, Boolean::subtract, context);
}
ExactSolid intersect(const ExactSolid& a, const ExactSolid& b, Context& context) {
  return boolean(a, b, Boolean::intersect, context);
}

}  // namespace formwright
