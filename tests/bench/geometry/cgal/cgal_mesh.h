// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Our mesh as CGAL's and back, for the comparisons of this folder. For their own files alone: it drags in CGAL.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>

#include <vector>

#include "geometry/mesh/triangle_mesh.h"

namespace formwright::bench {

using CgalKernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalMesh = CGAL::Surface_mesh<CgalKernel::Point_3>;

/// Vertices and faces keep their numbers. Needs a manifold mesh with faces oriented alike.
inline CgalMesh to_cgal(const TriangleMesh& mesh) {
  CgalMesh result;
  for (int v = 0; v < mesh.vertex_count(); ++v)
    result.add_vertex(CgalKernel::Point_3(mesh.V(v, 0), mesh.V(v, 1), mesh.V(v, 2)));
  const auto vertex = [&](int f, int k) { return CgalMesh::Vertex_index(static_cast<unsigned>(mesh.F(f, k))); };
  for (int f = 0; f < mesh.face_count(); ++f) result.add_face(vertex(f, 0), vertex(f, 1), vertex(f, 2));
  return result;
}

/// Survivors keep their order. `name`, when given, gets the new number of every old vertex, -1 for none.
inline TriangleMesh from_cgal(const CgalMesh& mesh, std::vector<int>* name = nullptr) {
  TriangleMesh result;
  std::vector<int> number(mesh.num_vertices(), -1);
  result.V.resize(static_cast<Eigen::Index>(mesh.number_of_vertices()), 3);
  result.F.resize(static_cast<Eigen::Index>(mesh.number_of_faces()), 3);
  int n = 0;
  for (const auto v : mesh.vertices()) {
    const auto& p = mesh.point(v);
    result.V.row(n) << p.x(), p.y(), p.z();
    number[v.idx()] = n++;
  }
  Eigen::Index f = 0;
  for (const auto face : mesh.faces()) {
    int k = 0;
    for (const auto v : mesh.vertices_around_face(mesh.halfedge(face))) result.F(f, k++) = number[v.idx()];
    ++f;
  }
  if (name != nullptr) *name = std::move(number);
  return result;
}

}  // namespace formwright::bench
