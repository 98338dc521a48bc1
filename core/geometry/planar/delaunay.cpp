// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/planar/delaunay.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace formwright {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<int, Kernel>;  // index of the point, -1 for a crossing
using FaceBase = CGAL::Constrained_triangulation_face_base_2<
    Kernel, CGAL::Triangulation_face_base_with_info_2<int, Kernel>>;  // number of the face
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>,
                                               CGAL::Exact_predicates_tag>;

/// Whether an odd number of constrained edges is between the outside and each face; numbers the faces.
std::vector<char> odd_faces(Triangulation& triangulation) {
  int count = 0;
  for (const auto f : triangulation.all_face_handles()) f->info() = count++;
  std::vector<char> odd(static_cast<std::size_t>(count), 0), reached(static_cast<std::size_t>(count), 0);
  std::vector<Triangulation::Face_handle> open{triangulation.infinite_face()};
  reached[static_cast<std::size_t>(open.front()->info())] = 1;
  while (!open.empty()) {
    const auto face = open.back();
    open.pop_back();
    for (int k = 0; k < 3; ++k) {
      const auto next = face->neighbor(k);
      const auto at = static_cast<std::size_t>(next->info());
      if (reached[at]) continue;
      reached[at] = 1;
      const bool crosses = face->is_constrained(k);
      odd[at] = static_cast<char>(odd[static_cast<std::size_t>(face->info())] ^ static_cast<char>(crosses));
      open.push_back(next);
    }
  }
  return odd;
}

}  // namespace

PlaneTriangles constrained_delaunay(const std::vector<Vec2>& points, const std::vector<std::array<int, 2>>& edges) {
  Triangulation triangulation;
  std::vector<Triangulation::Vertex_handle> vertex;
  vertex.reserve(points.size());
  Triangulation::Face_handle near;
  for (const Vec2& p : points) {
    vertex.push_back(triangulation.insert(Kernel::Point_2(p.x(), p.y()), near));
    if (triangulation.dimension() == 2) near = vertex.back()->face();
  }
  if (triangulation.dimension() < 2) return {points, {}, {}};
  for (const auto& [a, b] : edges) {
    const auto from = vertex[static_cast<std::size_t>(a)], to = vertex[static_cast<std::size_t>(b)];
    if (from != to) triangulation.insert_constraint(from, to);
  }
  PlaneTriangles result;
  result.points = points;
  for (const auto v : triangulation.finite_vertex_handles()) v->info() = -1;
  for (std::size_t i = points.size(); i-- > 0;) vertex[i]->info() = static_cast<int>(i);  // the first of several
  for (const auto v : triangulation.finite_vertex_handles()) {
    if (v->info() >= 0) continue;
    v->info() = static_cast<int>(result.points.size());
    result.points.emplace_back(v->point().x(), v->point().y());
  }
  const std::vector<char> odd = odd_faces(triangulation);
  for (const auto f : triangulation.finite_face_handles()) {
    result.triangles.emplace_back(f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info());
    result.enclosed.push_back(odd[static_cast<std::size_t>(f->info())]);
  }
  return result;
}

PlaneTriangles triangles_of(const Region& region, double max_edge, const std::vector<Vec2>& inner) {
  std::vector<Vec2> points;
  std::vector<std::array<int, 2>> edges;
  for (const std::vector<Vec2>& ring : region.rings) {
    const int first = static_cast<int>(points.size());
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
      const int pieces = std::max(1, static_cast<int>(std::ceil((b - a).norm() / max_edge)));
      for (int piece = 0; piece < pieces; ++piece) points.push_back(a + (b - a) * piece / pieces);
    }
    const int end = static_cast<int>(points.size());
    for (int i = first; i < end; ++i) edges.push_back({i, i + 1 < end ? i + 1 : first});
  }
  points.insert(points.end(), inner.begin(), inner.end());
  PlaneTriangles result = constrained_delaunay(points, edges);
  std::size_t kept = 0;
  for (std::size_t f = 0; f < result.triangles.size(); ++f)
    if (result.enclosed[f]) result.triangles[kept++] = result.triangles[f];
  result.triangles.resize(kept);
  result.enclosed.assign(kept, 1);
  return result;
}

}  // namespace formwright
