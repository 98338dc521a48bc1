// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/repair/repair.h"

#include <catch2/catch_test_macros.hpp>

#include <limits>
#include <string>

#include "base/error.h"
#include "geometry/repair/repaired.h"
#include "geometry/test_meshes.h"

namespace formwright {
namespace {
using namespace test;

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
