// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/geometry/cgal/cgal_repair.h"

#include <CGAL/Polygon_mesh_processing/autorefinement.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_degeneracies.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>

#include <array>
#include <vector>

#include "bench/geometry/cgal/cgal_mesh.h"

namespace formwright::bench {

namespace processing = CGAL::Polygon_mesh_processing;

TriangleMesh cgal_repair(const TriangleMesh& soup, bool autorefine) {
  std::vector<CgalKernel::Point_3> points;
  std::vector<std::array<std::size_t, 3>> faces;
  for (int v = 0; v < soup.vertex_count(); ++v) points.emplace_back(soup.V(v, 0), soup.V(v, 1), soup.V(v, 2));
  for (int f = 0; f < soup.face_count(); ++f)
    faces.push_back({static_cast<std::size_t>(soup.F(f, 0)), static_cast<std::size_t>(soup.F(f, 1)),
                     static_cast<std::size_t>(soup.F(f, 2))});
  processing::repair_polygon_soup(points, faces);
  if (autorefine) processing::autorefine_triangle_soup(points, faces);
  processing::orient_polygon_soup(points, faces);
  CgalMesh mesh;
  processing::polygon_soup_to_polygon_mesh(points, faces, mesh);
  processing::stitch_borders(mesh);
  processing::remove_degenerate_faces(mesh);
  if (CGAL::is_closed(mesh) && !CGAL::is_empty(mesh)) processing::orient_to_bound_a_volume(mesh);
  return from_cgal(mesh);
}

}  // namespace formwright::bench
