// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/geometry/cgal/cgal_polygons.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/mark_domain_in_triangulation.h>
#include <CGAL/utility.h>

#include <Eigen/Geometry>

namespace formwright::bench {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Patch = std::vector<CGAL::Triple<int, int, int>>;

std::vector<Kernel::Point_3> points_of(std::span<const Vec3> corners) {
  std::vector<Kernel::Point_3> points;
  points.reserve(corners.size());
  for (const Vec3& p : corners) points.emplace_back(p.x(), p.y(), p.z());
  return points;
}

PolygonTriangles triangles_of(const Patch& patch) {
  PolygonTriangles triangles;
  for (const auto& t : patch) triangles.push_back({t.first, t.second, t.third});
  return triangles;
}

}  // namespace

PolygonTriangles cgal_polyline(std::span<const Vec3> corners) {
  Patch patch;
  CGAL::Polygon_mesh_processing::triangulate_hole_polyline(
      points_of(corners), std::back_inserter(patch), CGAL::parameters::use_2d_constrained_delaunay_triangulation(true));
  return triangles_of(patch);
}

PolygonTriangles cgal_delaunay(std::span<const Vec3> corners) {
  using Vertex = CGAL::Triangulation_vertex_base_with_info_2<int, Kernel>;
  using Face = CGAL::Constrained_triangulation_face_base_2<Kernel>;
  using Triangulation =
      CGAL::Constrained_Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<Vertex, Face>,
                                                 CGAL::No_constraint_intersection_tag>;
  Vec3 normal = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    normal += (corners[i] - corners[0]).cross(corners[i + 1] - corners[0]);
  if (!(normal.norm() > 0)) return {};
  normal.normalize();
  int smallest = 0;
  normal.cwiseAbs().minCoeff(&smallest);
  const Vec3 u = normal.cross(Vec3::Unit(smallest)).normalized(), v = normal.cross(u);
  std::vector<std::pair<Kernel::Point_2, int>> flat;
  for (std::size_t i = 0; i < corners.size(); ++i)
    flat.emplace_back(Kernel::Point_2((corners[i] - corners[0]).dot(u), (corners[i] - corners[0]).dot(v)),
                      static_cast<int>(i));
  Triangulation triangulation;
  triangulation.insert(flat.begin(), flat.end());
  if (triangulation.number_of_vertices() != corners.size()) return {};
  std::vector<Triangulation::Vertex_handle> handle(corners.size());
  for (const auto vertex : triangulation.finite_vertex_handles())
    handle[static_cast<std::size_t>(vertex->info())] = vertex;
  try {
    for (std::size_t i = 0; i < handle.size(); ++i)
      triangulation.insert_constraint(handle[i], handle[(i + 1) % handle.size()]);
  } catch (const Triangulation::Intersection_of_constraints_exception&) {
    return {};
  }
  std::unordered_map<Triangulation::Face_handle, bool> inside;
  CGAL::mark_domain_in_triangulation(triangulation, boost::associative_property_map(inside));
  PolygonTriangles triangles;
  for (const auto face : triangulation.finite_face_handles())
    if (inside[face]) triangles.push_back({face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()});
  return triangles;
}

PolygonTriangles cgal_fill_hole(std::span<const Vec3> corners, std::span<const Vec3> beyond, bool delaunay) {
  Patch patch;
  CGAL::Polygon_mesh_processing::triangulate_hole_polyline(
      points_of(corners), points_of(beyond), std::back_inserter(patch),
      CGAL::parameters::use_delaunay_triangulation(delaunay).use_2d_constrained_delaunay_triangulation(false));
  return triangles_of(patch);
}

}  // namespace formwright::bench
