// SPDX-License-Identifier: GPL-3.0-or-later
// Which faces belong together, and on which side they face out.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "geometry/mesh/measures.h"
#include "geometry/repair/repaired.h"
#include "geometry/test_meshes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using namespace test;

TEST_CASE("Repair.TouchingSolidsComeApartClosed") {
  // Cubes that share an edge, a corner, or a wall given twice: two closed cubes each time.
  for (const Vec3& shift : {Vec3(1, 1, 0), Vec3(1, 1, 1), Vec3(1, 0, 0)}) {
    const TriangleMesh mesh = joined(cube(), moved(cube(), shift));
    const RepairedMesh result = repaired(mesh);
    expect_sound(mesh, result);
    {
      INFO(said(result));
      CHECK(result.closed());
    }
    CHECK(result.part_count == 2);
    CHECK(result.mesh.face_count() == 24);
    CHECK_THAT(signed_volume(result.mesh), WithinAbs(2, 1e-14));
  }
}

TEST_CASE("Repair.WallInsideASolidComesOff") {
  // A box of two cubes with the wall between them given once: a closed box, and the wall beside it.
  TriangleMesh mesh = joined(cube(), moved(cube(), Vec3(1, 0, 0)));
  std::vector<std::array<int, 3>> faces;
  for (int f = 0; f < 24; ++f) {
    bool wall = true;
    for (int k = 0; k < 3; ++k) wall = wall && mesh.V(mesh.F(f, k), 0) == 1;
    if (!wall || f < 12) faces.push_back({mesh.F(f, 0), mesh.F(f, 1), mesh.F(f, 2)});
  }
  REQUIRE(faces.size() == 22u);
  TriangleMesh walled = make_mesh({}, faces);
  walled.V = mesh.V;
  const RepairedMesh result = repaired(walled);
  expect_sound(walled, result);
  // The wall belongs to the first cube, whose normals agree with it; the second stays open where it was.
  CHECK(result.part_count == 2);
  CHECK(result.hole_count == 1);
}

TEST_CASE("Repair.ThreePagesComeApart") {
  const TriangleMesh book =
      make_mesh({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, -1, 0}}, {{{0, 1, 2}}, {{1, 0, 3}}, {{0, 1, 4}}});
  const RepairedMesh result = repaired(book);
  expect_sound(book, result);
  CHECK(result.mesh.face_count() == 3);
  CHECK(said(result).find("Separated the surface along 1 edge where more than two triangles met.") !=
        std::string::npos);
}

TEST_CASE("Repair.SheetsThatTouchAtAVertex") {
  const TriangleMesh bow =
      make_mesh({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}}, {{{0, 1, 2}}, {{0, 3, 4}}});
  const RepairedMesh result = repaired(bow);
  expect_sound(bow, result);
  CHECK(result.mesh.vertex_count() == 6);
  CHECK(result.vertex_of == std::vector<int>{0, 1, 2, 3, 4, 0});
  CHECK(said(result).find("Separated the surface at 1 vertex where parts of the surface only touched.") !=
        std::string::npos);
}

TEST_CASE("Repair.PinchedEdgeKeepsTheSurfaceWhole") {
  // Pull two opposite vertices of a ring onto their neighbours across the hole: the torus pinches.
  TriangleMesh mesh = torus(12, 6, 0.4);
  const RepairedMesh before = repaired(mesh);
  mesh.V.row(0 * 6 + 3) = mesh.V.row(6 * 6 + 3);  // inner circle, opposite sides
  mesh.V.row(1 * 6 + 3) = mesh.V.row(7 * 6 + 3);
  const RepairedMesh result = repaired(mesh);
  expect_sound(mesh, result);
  {
    INFO(said(result));
    CHECK(result.closed());
  }
  CHECK(result.genus == before.genus);
}

TEST_CASE("Repair.OrientsByMajorityAndOutwards") {
  TriangleMesh mesh = icosphere(2);
  for (int f = 0; f < mesh.face_count(); f += 3) std::swap(mesh.F(f, 1), mesh.F(f, 2));
  RepairedMesh result = repaired(mesh);
  expect_sound(mesh, result);
  CHECK(signed_volume(result.mesh) > 4);
  CHECK(said(result) == "Turned 107 triangles to face the same way as the rest.\n");

  result = repaired(reversed(icosphere(2)));
  CHECK(signed_volume(result.mesh) > 4);
  CHECK(said(result) == "Turned 1 closed part to face outwards.\n");

  TriangleMesh sheet = grid(4, 4);
  std::swap(sheet.F(5, 1), sheet.F(5, 2));
  result = repaired(sheet);
  CHECK(face_normals(result.mesh).col(2).minCoeff() == 1);
}

TEST_CASE("Repair.CavitiesStayInsideOut") {
  const TriangleMesh hollow = joined(icosphere(2), reversed(moved(icosphere(1), Vec3(0, 0, 0), 0.5)));
  const RepairedMesh result = repaired(hollow);
  CHECK(result.mesh.F == hollow.F);
  CHECK(said(result) == "");
  // Beside, not inside: turned.
  const TriangleMesh beside = joined(icosphere(2), reversed(moved(icosphere(1), Vec3(3, 0, 0), 0.5)));
  CHECK(said(repaired(beside)) == "Turned 1 closed part to face outwards.\n");
  // Loose in the cavity: two parts lie around it, so it is a solid again.
  CHECK(said(repaired(joined(hollow, reversed(moved(icosphere(1), Vec3(0, 0, 0), 0.2))))) ==
        "Turned 1 closed part to face outwards.\n");
}

TEST_CASE("Repair.ManyPartsAreTurnedWithoutComparingEachWithAll") {
  // 8,000 crumbs inside out in the cavity of a ball: by pairs that would be 64 million comparisons.
  const int n = 20;
  const TriangleMesh crumb = reversed(moved(icosphere(0), Vec3(0, 0, 0), 0.01));
  TriangleMesh mesh = joined(icosphere(2), reversed(moved(icosphere(1), Vec3(0, 0, 0), 0.9)));
  const int first = mesh.vertex_count(), first_face = mesh.face_count(), crumbs = n * n * n;
  mesh.V.conservativeResize(first + crumbs * crumb.vertex_count(), 3);
  mesh.F.conservativeResize(first_face + crumbs * crumb.face_count(), 3);
  for (int i = 0; i < crumbs; ++i) {
    const Vec3 place = 0.04 * Vec3(i % n - 9.5, i / n % n - 9.5, i / n / n - 9.5);
    const int v = first + i * crumb.vertex_count();
    mesh.V.middleRows(v, crumb.vertex_count()) = crumb.V.rowwise() + place.transpose();
    mesh.F.middleRows(first_face + i * crumb.face_count(), crumb.face_count()) = crumb.F.array() + v;
  }
  CHECK(said(repaired(mesh)) == "Turned 8000 closed parts to face outwards.\n");
}

TEST_CASE("Repair.OneSidedSurfacesAreCutOpen") {
  const TriangleMesh band = moebius_band(12);
  const RepairedMesh result = repaired(band);
  expect_sound(band, result);
  CHECK(result.mesh.face_count() == band.face_count());
  CHECK(result.part_count == 1);
  CHECK(said(result).find("only one side") != std::string::npos);

  // Klein bottle: the torus glued with a flip, closed and one-sided.
  TriangleMesh klein = torus(16, 8);
  for (int f = 0; f < klein.face_count(); ++f)
    if (f / 16 == 15)
      for (int k = 0; k < 3; ++k)
        if (klein.F(f, k) < 8) klein.F(f, k) = (8 - klein.F(f, k)) % 8;
  expect_sound(klein, repaired(klein));
}

}  // namespace
}  // namespace formwright
