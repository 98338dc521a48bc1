// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/repair/repair.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>
#include <limits>
#include <set>

#include "base/error.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/measures.h"
#include "geometry/test_meshes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using namespace test;

RepairedMesh repaired(const TriangleMesh& mesh, const RepairOptions& options = {}) {
  Context context;
  return repair(mesh, options, context);
}

std::string said(const RepairedMesh& result) {
  std::string all;
  for (const std::string& sentence : result.sentences) all += sentence + "\n";
  return all;
}

/// What holds for every result: manifold, oriented, no flat or unused pieces, maps that point at the same place.
void expect_sound(const TriangleMesh& before, const RepairedMesh& after) {
  const Adjacency adjacency(after.mesh);
  REQUIRE(adjacency.nonmanifold_edge_count() == 0);
  REQUIRE(adjacency.inconsistent_edge_count() == 0);
  REQUIRE(adjacency.nonmanifold_vertices().empty());
  REQUIRE(after.mesh.V.allFinite());
  REQUIRE(after.vertex_of.size() == static_cast<std::size_t>(after.mesh.vertex_count()));
  REQUIRE(after.face_of.size() == static_cast<std::size_t>(after.mesh.face_count()));
  REQUIRE(after.corner_of.size() == static_cast<std::size_t>(3 * after.mesh.face_count()));
  for (int v = 0; v < after.mesh.vertex_count(); ++v) REQUIRE_FALSE(adjacency.outgoing(v).empty());
  std::set<std::array<int, 3>> faces;
  for (int f = 0; f < after.mesh.face_count(); ++f) {
    std::array<int, 3> corners{after.mesh.F(f, 0), after.mesh.F(f, 1), after.mesh.F(f, 2)};
    std::sort(corners.begin(), corners.end());
    REQUIRE(corners[0] < corners[1]);
    REQUIRE(corners[1] < corners[2]);
    faces.insert(corners);
    REQUIRE(after.face_of[static_cast<std::size_t>(f)] < before.face_count());
    for (int k = 0; k < 3; ++k) {
      const int old = after.corner_of[static_cast<std::size_t>(3 * f + k)];
      REQUIRE(old >= 0);
      REQUIRE(old < 3 * before.face_count());
    }
  }
  REQUIRE(after.part_count == face_components(adjacency).count);
  REQUIRE(after.hole_count == static_cast<int>(boundary_loops(adjacency).size()));
  REQUIRE(2 * after.part_count - 2 * after.genus - after.hole_count == euler_characteristic(adjacency));
}

TEST_CASE("Repair.SoundMeshesComeBackUnchanged") {
  for (const TriangleMesh& mesh :
       {cube(), icosphere(3), torus(20, 12), joined(cube(), moved(torus(9, 7), Vec3(5, 0, 0)))}) {
    const RepairedMesh result = repaired(mesh);
    CHECK(result.mesh.V == mesh.V);
    CHECK(result.mesh.F == mesh.F);
    CHECK(said(result) == "");
    CHECK(result.closed());
    expect_sound(mesh, result);
  }
  CHECK(repaired(torus(20, 12)).genus == 1);
  CHECK(repaired(joined(cube(), moved(torus(9, 7), Vec3(5, 0, 0)))).part_count == 2);
}

TEST_CASE("Repair.OpenSurfacesAreReported") {
  CHECK(said(repaired(tube(9, 3))) ==
        "The surface has 2 holes. Fine for reliefs; a zippable or a mould needs a closed surface.\n");
  CHECK(said(repaired(grid(3, 3))) ==
        "The surface has 1 hole. Fine for reliefs; a zippable or a mould needs a closed surface.\n");
}

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

TEST_CASE("Repair.FillsHoles") {
  TriangleMesh mesh = icosphere(3);
  const double volume = signed_volume(mesh);
  // Takes out the faces around vertices 0 (5 faces) and 100 (6 faces).
  std::vector<std::array<int, 3>> faces;
  for (int f = 0; f < mesh.face_count(); ++f) {
    bool out = false;
    for (int k = 0; k < 3; ++k) out = out || mesh.F(f, k) == 0 || mesh.F(f, k) == 100;
    if (!out) faces.push_back({mesh.F(f, 0), mesh.F(f, 1), mesh.F(f, 2)});
  }
  TriangleMesh holed = make_mesh({}, faces);
  holed.V = mesh.V;
  CHECK(repaired(holed).hole_count == 2);
  RepairOptions options;
  options.fill_holes_up_to_edges = 5;
  CHECK(repaired(holed, options).hole_count == 1);
  options.fill_holes_up_to_edges = 20;
  const RepairedMesh result = repaired(holed, options);
  expect_sound(holed, result);
  CHECK(result.closed());
  CHECK_THAT(signed_volume(result.mesh), WithinAbs(volume, 0.02 * volume));
  CHECK(said(result).find("Filled 2 holes with 7 triangles.") != std::string::npos);
  CHECK(std::count(result.face_of.begin(), result.face_of.end(), -1) == 7);
  // A tube's ends close to a solid cylinder; the rim of a flat sheet does not close onto the sheet.
  options.fill_holes_up_to_edges = 30;
  CHECK(repaired(tube(24, 2), options).closed());
  CHECK_FALSE(repaired(grid(3, 3), options).closed());
}

TEST_CASE("Repair.DropsSmallParts") {
  const TriangleMesh mesh = joined(moved(tetrahedron(), Vec3(5, 0, 0), 0.01), icosphere(2));
  RepairOptions options;
  options.drop_parts_below_percent = 1;
  const RepairedMesh result = repaired(mesh, options);
  expect_sound(mesh, result);
  CHECK(result.part_count == 1);
  CHECK(result.mesh.vertex_count() == 162);
  CHECK(said(result) == "Dropped 1 small part (4 triangles).\n");
  CHECK(repaired(mesh).part_count == 2);
  options.drop_parts_below_percent = 50;
  CHECK(repaired(joined(cube(), moved(cube(), Vec3(3, 0, 0))), options).part_count == 2);  // never all of it
}

TEST_CASE("Repair.UnusedAndNotANumber") {
  TriangleMesh mesh = joined(cube(), moved(cube(), Vec3(4, 0, 0)));
  mesh.V.conservativeResize(17, 3);
  mesh.V.row(16).setConstant(3);
  mesh.V(15, 1) = std::numeric_limits<double>::quiet_NaN();
  const RepairedMesh result = repaired(mesh);
  expect_sound(mesh, result);
  CHECK(result.mesh.vertex_count() == 15);
  INFO(said(result));
  CHECK(result.sentences.size() == 3u);
}

TEST_CASE("Repair.RandomSoupsBecomeManifold") {
  for (std::uint64_t seed = 1; seed <= 1500; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    const int n = 4 + random.below(10), m = 1 + random.below(60);
    TriangleMesh soup;
    soup.V.resize(n, 3);
    // A coarse lattice, so that places coincide and triangles degenerate.
    for (int v = 0; v < n; ++v)
      for (int k = 0; k < 3; ++k) soup.V(v, k) = seed % 2 == 0 ? random.below(3) : random.uniform();
    soup.F.resize(m, 3);
    for (int f = 0; f < m; ++f)
      for (int k = 0; k < 3; ++k) soup.F(f, k) = random.below(n);
    RepairOptions options;
    if (seed % 3 == 0) options.fill_holes_up_to_edges = 8;
    if (seed % 5 == 0) options.merge_tolerance_mm = 0.2;
    try {
      expect_sound(soup, repaired(soup, options));
    } catch (const Error& error) {
      {
        INFO(error.what());
        CHECK(error.code() == ErrorCode::invalid_input);
      }  // nothing with an area
      CHECK((m < 10 || options.merge_tolerance_mm > 0));
    }
  }
}

TEST_CASE("Repair.RepairingTwiceChangesNothingMore") {
  Random random(77);
  TriangleMesh soup;
  soup.V.resize(12, 3);
  for (int v = 0; v < 12; ++v) soup.V.row(v) = random.in_cube();
  soup.F.resize(40, 3);
  for (int f = 0; f < 40; ++f)
    for (int k = 0; k < 3; ++k) soup.F(f, k) = random.below(12);
  RepairOptions keep_apart;
  keep_apart.merge_duplicates = false;  // or the cuts would be welded again
  const RepairedMesh once = repaired(soup), twice = repaired(once.mesh, keep_apart);
  CHECK(twice.mesh.F == once.mesh.F);
  CHECK(twice.mesh.V == once.mesh.V);
}

TEST_CASE("Repair.ModelsKeepTheirAttributes") {
  Model model;
  model.mesh = unwelded(cube());
  model.vertex_colours = Positions::Zero(36, 3);
  for (int v = 0; v < 36; ++v) model.vertex_colours(v, 0) = model.mesh.V(v, 0);
  model.UV.resize(36, 2);
  model.FT.resize(12, 3);
  for (int c = 0; c < 36; ++c) {
    model.UV.row(c) << c, -c;
    model.FT(c / 3, c % 3) = c;
  }
  model.group_names = {"lower", "upper"};
  for (int f = 0; f < 12; ++f) model.face_group.push_back(f < 6 ? 0 : 1);
  std::swap(model.mesh.F(7, 1), model.mesh.F(7, 2));
  std::swap(model.FT(7, 1), model.FT(7, 2));
  const RepairedMesh fixed = repaired(model.mesh);
  const Model result = repaired_model(model, fixed);
  REQUIRE(result.mesh.face_count() == 12);
  CHECK(result.vertex_colours.col(0) == result.mesh.V.col(0));
  CHECK(result.face_group == model.face_group);
  for (int f = 0; f < 12; ++f)
    for (int k = 0; k < 3; ++k) {
      // Texture vertex c belonged to soup vertex c, which lies where the new corner lies.
      CHECK(model.mesh.V.row(result.FT(f, k)) == result.mesh.V.row(result.mesh.F(f, k)));
    }
}

TEST_CASE("Repair.HopelessInput") {
  const auto code_and_place = [](const TriangleMesh& mesh) {
    try {
      repaired(mesh);
    } catch (const Error& error) {
      return std::string(to_string(error.code())) + " " + error.where();
    }
    return std::string("nothing");
  };
  CHECK(code_and_place(TriangleMesh{}) == "invalid_input mesh");
  CHECK(code_and_place(make_mesh({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{{0, 1, 2}}})) == "invalid_input mesh");
  CHECK(code_and_place(make_mesh({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, {{{0, 1, 2}}})) == "invalid_input mesh");
  CHECK(code_and_place(make_mesh({{0, 0, 0}, {1, 0, 0}}, {{{0, 1, 2}}})) == "invalid_input mesh");
  CHECK(code_and_place(moved(cube(), Vec3(0, 0, 0), 1e120)) == "invalid_input mesh");
  TriangleMesh broken = cube();
  broken.V.setConstant(std::numeric_limits<double>::infinity());
  CHECK(code_and_place(broken) == "invalid_input mesh");
  // Tiny is not flat.
  CHECK(code_and_place(moved(cube(), Vec3(0, 0, 0), 1e-90)) == "nothing");
  Host host;
  host.cancel_requested = [] { return true; };
  Context cancelled(host);
  CHECK_THROWS_AS(repair(cube(), {}, cancelled), Error);
}

}  // namespace
}  // namespace formwright
