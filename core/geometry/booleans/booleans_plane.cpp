// SPDX-License-Identifier: GPL-3.0-or-later
// Planar cuts of exact surfaces, and the flat caps that close them.
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

#include "base/error.h"
#include "geometry/booleans/booleans_surface.h"

namespace formwright {
namespace {

using Number = ExactKernel::FT;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<int, ExactKernel>;  // index of the point
using FaceBase = CGAL::Constrained_triangulation_face_base_2<
    ExactKernel, CGAL::Triangulation_face_base_with_info_2<int, ExactKernel>>;  // nesting
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<ExactKernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>,
                                               CGAL::No_constraint_intersection_requiring_constructions_tag>;

using DirectedEdge = std::array<int, 2>;

/// A half-edge of face f from corner k, under its ends in ascending order.
struct HalfEdge {
  int lower, higher, face, corner;
};

std::vector<HalfEdge> sorted_halfedges(const ExactSurface& surface) {
  std::vector<HalfEdge> all;
  all.reserve(3 * surface.faces.size());
  for (std::size_t f = 0; f < surface.faces.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(surface.faces[f][k], surface.faces[f][(k + 1) % 3]);
      all.push_back({a, b, static_cast<int>(f), static_cast<int>(k)});
    }
  std::ranges::sort(all, {}, [](const HalfEdge& h) { return std::tuple(h.lower, h.higher, h.face, h.corner); });
  return all;
}

[[noreturn]] void refuse_touching() {
  throw Error(ErrorCode::could_not_solve, "",
              "A cut through the model touches itself along an edge, which no mesh may: move the cut by a fraction of "
              "a millimetre (sink_mm, or the printer's size).");
}

}  // namespace

void separate_fans(ExactSurface& surface) {
  const std::vector<HalfEdge> halfedges = sorted_halfedges(surface);
  std::vector<int> parent(3 * surface.faces.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int i) {
    while (parent[static_cast<std::size_t>(i)] != i)
      i = parent[static_cast<std::size_t>(i)] = parent[static_cast<std::size_t>(parent[static_cast<std::size_t>(i)])];
    return i;
  };
  const auto join = [&](int a, int b) {
    parent[static_cast<std::size_t>(std::max(root(a), root(b)))] = std::min(root(a), root(b));
  };
  for (std::size_t i = 0; i < halfedges.size();) {
    std::size_t end = i + 1;
    while (end < halfedges.size() && halfedges[end].lower == halfedges[i].lower &&
           halfedges[end].higher == halfedges[i].higher)
      ++end;
    if (end - i > 2) refuse_touching();
    if (end - i == 2) {
      const HalfEdge &g = halfedges[i], &h = halfedges[i + 1];
      const int g_end = 3 * g.face + (g.corner + 1) % 3, h_end = 3 * h.face + (h.corner + 1) % 3;
      join(3 * g.face + g.corner, h_end);
      join(g_end, 3 * h.face + h.corner);
    }
    i = end;
  }
  std::vector<int> fresh(parent.size(), -1);
  std::vector<ExactPoint> points;
  points.reserve(surface.points.size());
  std::vector<std::array<int, 3>> faces = surface.faces;
  for (std::size_t corner = 0; corner < parent.size(); ++corner) {
    const auto top = static_cast<std::size_t>(root(static_cast<int>(corner)));
    if (fresh[top] < 0) {
      fresh[top] = static_cast<int>(points.size());
      points.push_back(surface.points[static_cast<std::size_t>(surface.faces[corner / 3][corner % 3])]);
    }
    faces[corner / 3][corner % 3] = fresh[top];
  }
  surface = {std::move(points), std::move(faces)};
}

ExactSurface clipped(const ExactSurface& surface, int axis, double offset_mm, bool upper, const Context& context) {
  const Number offset(offset_mm);
  std::vector<int> side(surface.points.size());
  for (std::size_t i = 0; i < side.size(); ++i) {
    const int sign = static_cast<int>(CGAL::compare(surface.points[i][axis], offset));
    side[i] = upper ? sign : -sign;
  }
  ExactSurface result;
  result.points = surface.points;
  // Crossed edges, each cut once, so that neighbours share the new point.
  std::vector<DirectedEdge> crossed;
  const auto crosses = [&](int a, int b) {
    return side[static_cast<std::size_t>(a)] * side[static_cast<std::size_t>(b)] < 0;
  };
  for (const auto& face : surface.faces)
    for (std::size_t k = 0; k < 3; ++k)
      if (const auto [a, b] = std::minmax(face[k], face[(k + 1) % 3]); crosses(a, b)) crossed.push_back({a, b});
  std::ranges::sort(crossed);
  crossed.erase(std::unique(crossed.begin(), crossed.end()), crossed.end());
  const auto first_new = static_cast<int>(surface.points.size());
  for (const auto& [a, b] : crossed) {
    const ExactPoint &p = surface.points[static_cast<std::size_t>(a)], &q = surface.points[static_cast<std::size_t>(b)];
    const Number t = (offset - p[axis]) / (q[axis] - p[axis]);
    std::array<Number, 3> x;
    for (int k = 0; k < 3; ++k) x[static_cast<std::size_t>(k)] = k == axis ? offset : Number(p[k] + t * (q[k] - p[k]));
    result.points.emplace_back(x[0], x[1], x[2]);
  }
  context.check_cancelled();
  const auto cut_point = [&](int a, int b) {
    const DirectedEdge edge{std::min(a, b), std::max(a, b)};
    return first_new + static_cast<int>(std::ranges::lower_bound(crossed, edge) - crossed.begin());
  };
  for (const auto& face : surface.faces) {
    std::vector<int> polygon;  // at most 4 corners
    bool inside = false;
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = face[k], b = face[(k + 1) % 3];
      const int side_a = side[static_cast<std::size_t>(a)];
      inside |= side_a > 0;
      if (side_a >= 0) polygon.push_back(a);
      if (crosses(a, b)) polygon.push_back(cut_point(a, b));
    }
    if (!inside) continue;
    for (std::size_t k = 2; k < polygon.size(); ++k) result.faces.push_back({polygon[0], polygon[k - 1], polygon[k]});
  }
  return result;
}

std::vector<DirectedEdge> border_edges(const ExactSurface& surface) {
  const std::vector<HalfEdge> halfedges = sorted_halfedges(surface);
  std::vector<DirectedEdge> border;
  for (std::size_t i = 0; i < halfedges.size();) {
    std::size_t end = i + 1;
    while (end < halfedges.size() && halfedges[end].lower == halfedges[i].lower &&
           halfedges[end].higher == halfedges[i].higher)
      ++end;
    if ((end - i) % 2 == 1) {
      const auto& face = surface.faces[static_cast<std::size_t>(halfedges[i].face)];
      const auto k = static_cast<std::size_t>(halfedges[i].corner);
      border.push_back({face[k], face[(k + 1) % 3]});
    }
    i = end;
  }
  return border;
}

bool edges_manifold(const ExactSurface& surface) {
  const std::vector<HalfEdge> halfedges = sorted_halfedges(surface);
  for (std::size_t i = 2; i < halfedges.size(); ++i)
    if (halfedges[i].lower == halfedges[i - 2].lower && halfedges[i].higher == halfedges[i - 2].higher) return false;
  return true;
}

std::vector<std::array<int, 3>> planar_filling(const std::vector<ExactPoint>& points,
                                               const std::vector<DirectedEdge>& edges, int axis) {
  std::vector<int> used;
  for (const auto& [a, b] : edges) used.insert(used.end(), {a, b});
  std::ranges::sort(used);
  used.erase(std::unique(used.begin(), used.end()), used.end());
  Triangulation triangulation;
  std::vector<std::pair<ExactKernel::Point_2, int>> flat;
  for (const int i : used) {
    const ExactPoint& p = points[static_cast<std::size_t>(i)];
    flat.emplace_back(ExactKernel::Point_2(p[(axis + 1) % 3], p[(axis + 2) % 3]), i);
  }
  triangulation.insert(flat.begin(), flat.end());
  std::vector<Triangulation::Vertex_handle> handles(used.size());
  for (const auto vertex : triangulation.finite_vertex_handles())
    handles[static_cast<std::size_t>(std::ranges::lower_bound(used, vertex->info()) - used.begin())] = vertex;
  const auto handle = [&](int i) {
    return handles[static_cast<std::size_t>(std::ranges::lower_bound(used, i) - used.begin())];
  };
  try {
    for (const auto& [a, b] : edges) {
      if (handle(a) == nullptr || handle(b) == nullptr) refuse_touching();  // two points at the same place
      triangulation.insert_constraint(handle(a), handle(b));
    }
  } catch (const Triangulation::Intersection_of_constraints_exception&) {
    refuse_touching();
  }
  std::vector<std::array<int, 3>> filling;
  if (triangulation.dimension() < 2) return filling;
  for (const auto face : triangulation.all_face_handles()) face->info() = -1;
  std::vector<Triangulation::Face_handle> level{triangulation.infinite_face()}, next;
  for (int nesting = 0; !level.empty(); ++nesting) {  // flood between constraints, from outside inwards
    while (!level.empty()) {
      const auto face = level.back();
      level.pop_back();
      if (face->info() >= 0) continue;
      face->info() = nesting;
      for (int k = 0; k < 3; ++k)
        if (const auto neighbour = face->neighbor(k); neighbour->info() < 0)
          (triangulation.is_constrained({face, k}) ? next : level).push_back(neighbour);
    }
    std::erase_if(next, [](const auto face) { return face->info() >= 0; });
    std::swap(level, next);
  }
  for (const auto face : triangulation.finite_face_handles())
    if (face->info() % 2 == 1)
      filling.push_back({face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()});
  // The triangulation's own order depends on addresses nowhere, but sorted lists stay sorted whatever CGAL does.
  for (auto& face : filling) std::ranges::rotate(face, std::ranges::min_element(face));
  std::ranges::sort(filling);
  return filling;
}

ExactSolid ExactSolid::half(int axis, double offset_mm, bool upper, Context& context) const {
  if (empty()) return {};
  auto part = std::make_shared<Surface>(clipped(surface(), axis, offset_mm, upper, context));
  if (part->faces.empty()) return {};
  for (const auto& [a, b, c] : planar_filling(part->points, border_edges(*part), axis)) {
    if (upper) part->faces.push_back({a, c, b});
    else part->faces.push_back({a, b, c});
  }
  separate_fans(*part);
  if (!border_edges(*part).empty()) refuse_touching();
  return ExactSolid(part);
}

ExactSolid ExactSolid::section_prism(double top_mm, double bottom_mm, Context& context) const {
  if (empty()) return {};
  const Surface above = clipped(surface(), 2, top_mm, true, context);
  const std::vector<DirectedEdge> loops = border_edges(above);
  if (loops.empty()) return {};
  auto prism = std::make_shared<Surface>();
  prism->points = above.points;
  const auto count = static_cast<int>(above.points.size());
  for (const ExactPoint& p : above.points) prism->points.emplace_back(p.x(), p.y(), Number(bottom_mm));
  for (const auto& [a, b, c] : planar_filling(above.points, loops, 2)) {
    prism->faces.push_back({a, b, c});
    prism->faces.push_back({a + count, c + count, b + count});
  }
  // The surface above runs along its border with the solid on its left; walls below continue it.
  for (const auto& [a, b] : loops) {
    prism->faces.push_back({b, a, a + count});
    prism->faces.push_back({b, a + count, b + count});
  }
  separate_fans(*prism);
  if (!border_edges(*prism).empty()) refuse_touching();
  return ExactSolid(prism);
}

}  // namespace formwright
