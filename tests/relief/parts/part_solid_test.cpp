// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/parts/part_solid.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <string>

#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/measures.h"
#include "relief/parts/parted_relief.h"
#include "relief/parts/parts_fixture.h"
#include "relief/tiles/relief_tile.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

constexpr double tolerance_mm = 4e-3;

std::vector<PartPiece> pieces_of(const test::OnParts& on, bool numbered = false) {
  Context context;
  return parted_relief(*on.parts, on.relief.pieces, on.options, tolerance_mm, numbered, context);
}

TriangleMesh open_sheet_mm(double half_x, double half_y, double z) {
  TriangleMesh mesh;
  mesh.V.resize(4, 3);
  for (int i = 0; i < 4; ++i) mesh.V.row(i) << (i & 1 ? half_x : -half_x), (i & 2 ? half_y : -half_y), z;
  mesh.F.resize(2, 3);
  mesh.F << 0, 1, 2, 1, 3, 2;
  return mesh;
}

TEST_CASE("PartSolid.ABarePartIsItself") {
  const test::OnParts on = test::relief_on(
      test::joined(test::box_mm({-90, -90, -60}, {90, 90, -30}), test::box_mm({70, 70, -20}, {80, 85, -5})),
      test::options_on_parts(Projection::orthographic), 3);
  const std::vector<PartPiece> pieces = pieces_of(on);
  REQUIRE(pieces.size() == 2);
  CHECK(pieces[1].part == 1);
  CHECK(pieces[1].solid.watertight);
  CHECK(pieces[1].solid.mesh.F.rows() == 12);
  CHECK_THAT(pieces[1].solid.volume_mm3, WithinRel(10.0 * 15 * 15, 1e-6));
  CHECK_THAT(pieces[0].depth_mm, WithinAbs(25, 1e-9));
  CHECK_THAT(pieces[1].depth_mm, WithinAbs(0, 1e-9));
  CHECK_THAT(pieces[0].outline_mm.area(), WithinRel(180.0 * 180, 1e-9));
}

TEST_CASE("PartSolid.AnOpenPartGetsAFlatBack") {
  // Straight on a bare sheet becomes a plate: 0.01 mm within its outline on each side.
  const test::OnParts on =
      test::relief_on(test::joined(open_sheet_mm(80, 90, -30), test::moved(open_sheet_mm(3, 4, 0), {85, 80, -10})),
                      test::options_on_parts(Projection::orthographic), 3);
  const std::vector<PartPiece> pieces = pieces_of(on, true);
  REQUIRE(pieces.size() == 2);
  const PartPiece& bare = pieces[0].part == 1 ? pieces[0] : pieces[1];
  CHECK(bare.solid.watertight);
  CHECK(bare.solid.volume_mm3 <= 5.98 * 7.98 * on.options.plate_mm * (1 + 1e-6));
  for (const PartPiece& piece : pieces) {
    CHECK(piece.solid.watertight);
    const BoundingBox box = bounding_box(piece.solid.mesh);
    CHECK_THAT(box.lower.z(), WithinAbs((piece.part == 1 ? -10 : -30) - on.options.plate_mm, 1e-4));
  }
  CHECK((pieces[0].part == 0 ? pieces[0] : pieces[1]).solid.numbered);
}

test::OnParts wall_and_ball(Projection projection, double pixel_mm, double carve_mm = 0) {
  ReliefOptions options = test::options_on_parts(projection);
  options.pixel_mm = pixel_mm;
  options.carve_depth_mm = carve_mm;
  return test::relief_on(
      test::joined(test::box_mm({-90, -90, -60}, {90, 90, -30}), test::moved(test::icosphere(3), {10, 5, -14}, 15)),
      options);
}

TEST_CASE("PartSolid.IsClosedAndWithinItsSpace") {
  for (const Projection projection : {Projection::perspective, Projection::orthographic})
    for (const double carve_mm : {0.0, 2.0}) {
      INFO("carved " << carve_mm);
      const test::OnParts on = wall_and_ball(projection, 1, carve_mm);
      for (const PartPiece& piece : pieces_of(on, true)) {
        INFO("part " << piece.part);
        const TriangleMesh& mesh = piece.solid.mesh;
        const Adjacency adjacency(mesh);
        CHECK(adjacency.is_closed());
        CHECK(vertex_components(adjacency).count == 1);
        CHECK(piece.solid.numbered == (piece.part == 0));  // a ball has no flat back
        // Before the part's own front by the thickness at most, nowhere beside it.
        const TriangleMesh own{to_scene(on.parts->mesh(piece.part).V, on.options.width_mm),
                               on.parts->mesh(piece.part).F};
        const BoundingBox box = bounding_box(own);
        for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
          REQUIRE(mesh.V(i, 2) <= box.upper.z() + on.options.thickness_mm + 1e-3);
          REQUIRE(mesh.V(i, 2) >= box.lower.z() - 1e-3);
        }
        const double volume = std::abs(signed_volume(own)), front_mm2 = piece.outline_mm.area();
        CHECK(piece.solid.volume_mm3 < volume + front_mm2 * on.options.thickness_mm);
        if (carve_mm == 0) CHECK(piece.solid.volume_mm3 > volume - 30);  // the number
        else CHECK(piece.solid.volume_mm3 > 0.5 * volume);
      }
    }
}

TEST_CASE("PartSolid.LooksLikeTheReliefFromTheViewpoint") {
  const test::OnParts on = wall_and_ball(Projection::perspective, 0.5);
  const std::vector<PartPiece> pieces = pieces_of(on);
  TriangleMesh all = pieces[0].solid.mesh;
  for (std::size_t k = 1; k < pieces.size(); ++k) all = test::joined(all, pieces[k].solid.mesh);
  const TriangleMesh cut{to_scene(on.relief.pieces.V, on.options.width_mm), on.relief.pieces.F};
  const RayCaster solids(all), surface(cut);
  const Vec3 eye(0, 0, on.options.width_mm / on.frame.kappa);
  int rays = 0, differing = 0;
  for (int row = 0; row < 150; ++row)
    for (int column = 0; column < 150; ++column) {
      const Vec3 through(110 * ((column + 0.37) / 150 - 0.5), 110 * ((row + 0.41) / 150 - 0.5), 0);
      const Vec3 ray = (through - eye).normalized();
      const auto hit = surface.first_hit(eye, ray, 0, 5 * eye.z()), solid = solids.first_hit(eye, ray, 0, 5 * eye.z());
      REQUIRE(solid.has_value());
      if (!hit) continue;
      ++rays;
      differing += std::abs(hit->distance - solid->distance) > 0.25;
    }
  CHECK(rays > 10000);
  CAPTURE(differing, rays);
  CHECK(differing < 0.02 * rays);  // slopes one pixel wide at the model's outline and at the ball's
}

TEST_CASE("PartSolid.VolumesConverge") {
  std::vector<double> volumes;
  for (const double pixel_mm : {2.0, 1.0, 0.5, 0.25}) {
    double sum = 0;
    for (const PartPiece& piece : pieces_of(wall_and_ball(Projection::orthographic, pixel_mm)))
      sum += piece.solid.volume_mm3;
    volumes.push_back(sum);
  }
  const double coarse = std::abs(volumes[1] - volumes[0]), fine = std::abs(volumes[3] - volumes[2]);
  CAPTURE(volumes, std::log2(coarse / fine) / 2);
  CHECK(std::log2(coarse / fine) / 2 > 0.8);
}

TEST_CASE("PartSolid.PartsThatOverlapAreRefused") {
  Context context;
  const ReliefOptions options = test::options_on_parts(Projection::orthographic);
  // Their fronts do not cross as seen from the viewpoint.
  const test::OnParts on = test::relief_on(
      test::joined(test::box_mm({-90, -90, -60}, {90, 90, -30}), test::box_mm({-10, -10, -40}, {10, 10, -5})), options,
      3);
  try {
    pieces_of(on);
    FAIL("no error");
  } catch (const Error& error) {
    CHECK(std::string(error.what()).find("Parts 1 and 2 of the base overlap") != std::string::npos);
  }
}

}  // namespace
}  // namespace formwright
