// SPDX-License-Identifier: GPL-3.0-or-later
// Merging, triangles without area, duplicates.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>
#include <string>
#include <vector>

#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/measures.h"
#include "geometry/repair/repaired.h"
#include "geometry/test_meshes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using namespace test;

TEST_CASE("Repair.WeldsATriangleSoup") {
  const TriangleMesh soup = unwelded(icosphere(2));
  const RepairedMesh result = repaired(soup);
  expect_sound(soup, result);
  CHECK(result.mesh.vertex_count() == icosphere(2).vertex_count());
  CHECK(result.closed());
  CHECK(said(result) == "Merged 798 vertices that lie at the same place as another.\n");  // 3 * 320 - 162
  for (int v = 0; v < result.mesh.vertex_count(); ++v)
    CHECK(result.mesh.V.row(v) == soup.V.row(result.vertex_of[static_cast<std::size_t>(v)]));
  CHECK(std::is_sorted(result.vertex_of.begin(), result.vertex_of.end()));
  RepairOptions no_merging;
  no_merging.merge_duplicates = false;
  CHECK(repaired(soup, no_merging).part_count == 320);
}

TEST_CASE("Repair.WeldsWithinATolerance") {
  TriangleMesh soup = unwelded(icosphere(2));
  Random random(4);
  for (int v = 0; v < soup.vertex_count(); ++v) soup.V.row(v) += 0.004 * random.in_cube();
  CHECK(repaired(soup).part_count == 320);
  RepairOptions options;
  options.merge_tolerance_mm = 0.02;
  const RepairedMesh result = repaired(soup, options);
  expect_sound(soup, result);
  CHECK(result.mesh.vertex_count() == 162);
  CHECK(result.closed());
}

TEST_CASE("Repair.MinusZeroIsZero") {
  TriangleMesh mesh = unwelded(grid(1, 1));
  mesh.V.row(3)[2] = -0.0;
  CHECK(repaired(mesh).mesh.vertex_count() == 4);
}

TEST_CASE("Repair.RemovesWhatHasNoArea") {
  TriangleMesh mesh = cube();
  mesh.F.conservativeResize(15, 3);
  mesh.F.row(12) << 0, 1, 1;
  mesh.F.row(13) << 2, 2, 2;
  mesh.F.row(14) << 0, 7, 0;
  const RepairedMesh result = repaired(mesh);
  CHECK(said(result) == "Removed 3 triangles without area.\n");
  CHECK(result.mesh.F == cube().F);
}

TEST_CASE("Repair.TurnsAnEdgeInsteadOfOpeningACrack") {
  // A square whose diagonal carries an extra vertex in one half only, closed by a triangle without area.
  const TriangleMesh mesh = make_mesh({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 0}},
                                      {{{0, 1, 2}}, {{0, 2, 4}}, {{4, 2, 3}}, {{0, 4, 3}}});
  REQUIRE(Adjacency(mesh).is_manifold());
  const RepairedMesh result = repaired(mesh);
  expect_sound(mesh, result);
  CHECK(
      said(result) ==
      "Repaired 1 triangle without area by flipping an edge.\nThe surface has 1 hole. Fine for reliefs; a zippable or a mould needs a closed surface.\n");
  CHECK(result.mesh.face_count() == 4);
  CHECK(face_areas(result.mesh).minCoeff() > 0.4);
  CHECK_THAT(surface_area(result.mesh), WithinAbs(4, 1e-15));
  CHECK(boundary_loops(Adjacency(result.mesh))[0].size() == 4u);
}

TEST_CASE("Repair.CollapsesNeedles") {
  // A sphere with one vertex doubled 1e-14 away: two needles close the gap.
  TriangleMesh mesh = icosphere(1);
  const int n = mesh.vertex_count();
  const Adjacency adjacency(mesh);
  const int h = adjacency.outgoing(0)[0], g = adjacency.outgoing(0)[2];
  mesh.V.conservativeResize(n + 1, 3);
  mesh.V.row(n) = mesh.V.row(0) + Eigen::RowVector3d(1e-15, 1e-15, 0);
  // Faces between h and g, going round, move to the new vertex; needles fill the two slits.
  std::vector<int> moved_faces;
  int around = h;
  while (around / 3 != g / 3) {
    moved_faces.push_back(around);
    around = adjacency.opposite(previous_halfedge(around));
  }
  for (const int out : moved_faces) mesh.F(out / 3, out % 3) = n;
  const int first = adjacency.to(h), last = adjacency.to(around);
  mesh.F.conservativeResize(mesh.F.rows() + 2, 3);
  mesh.F.row(mesh.F.rows() - 2) << 0, n, first;
  mesh.F.row(mesh.F.rows() - 1) << n, 0, last;
  REQUIRE(Adjacency(mesh).boundary_edge_count() == 0);
  const RepairedMesh result = repaired(mesh);
  expect_sound(mesh, result);
  CHECK(result.closed());
  CHECK(result.mesh.vertex_count() == n);
  CHECK(result.mesh.face_count() == icosphere(1).face_count());
}

TEST_CASE("Repair.RemovesDuplicates") {
  TriangleMesh mesh = cube();
  mesh.F.conservativeResize(14, 3);
  mesh.F.row(12) = mesh.F.row(0);
  mesh.F.row(13) << mesh.F(3, 1), mesh.F(3, 2), mesh.F(3, 0);
  const RepairedMesh result = repaired(mesh);
  CHECK(said(result) == "Removed 2 duplicate triangles.\n");
  CHECK(result.mesh.F == cube().F);
}

TEST_CASE("Repair.OneSheetOfADoubleSidedSurface") {
  const TriangleMesh mesh = joined(grid(3, 3), reversed(grid(3, 3)));
  const RepairedMesh result = repaired(mesh);
  expect_sound(mesh, result);
  CHECK(result.mesh.face_count() == 18);
  CHECK(result.mesh.F == grid(3, 3).F);
  CHECK(said(result).find("Removed 18 triangles that duplicated the surface facing the other way.") !=
        std::string::npos);
}

}  // namespace
}  // namespace formwright
