// SPDX-License-Identifier: GPL-3.0-or-later
// Tiles without a relief: places, shapes and volumes in closed form.
#include "relief/tiles/relief_tile.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/measures.h"
#include "geometry/test_meshes.h"
#include "relief/base/base_shape.h"
#include "relief/tiles/tile_solid.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

constexpr PlateSize whole_plate{100, 80};

ReliefOptions on(BaseShape base, Projection projection, int count, double turn_deg = 0) {
  ReliefOptions options;
  options.width_mm = 100;
  options.base = base;
  options.base_depth_mm = 40;
  options.base_steps = count;
  options.base_turn_deg = turn_deg;
  options.projection = projection;
  return options;
}

struct Tiles {
  ViewFrame frame;
  BaseBands bands;
  std::vector<ReliefTile> tiles;
};

Tiles tiles_on(const ReliefOptions& options) {
  ViewFrame frame = make_view_frame(test::icosphere(2), options);
  frame.image_height = whole_plate.height_mm / whole_plate.width_mm;
  const BaseBands bands = *base_bands(options, frame);
  return {frame, bands, relief_tiles(frame, bands, whole_plate, options.width_mm)};
}

TileSolid bare(const ReliefTile& tile, double plate_mm, int number = 0) {
  Context context;
  TileSolidOptions options;
  options.plate_mm = plate_mm;
  options.number = number;
  options.tolerance_mm = 1e-6;
  return tile_solid(tile, tile_grid(tile, {}, options.room, 3, context), options, context);
}

/// Of the rays through a part of a plane between it and a plane `plate_mm` behind, by the distance of the viewpoint.
double volume_between(double area_mm2, double distance_mm, double plate_mm) {
  return area_mm2 * distance_mm / 3 * (std::pow(1 + plate_mm / distance_mm, 3) - 1);
}

TEST_CASE("ReliefTile.StepsStraightOnAreRectanglesFromTopToBottom") {
  const Tiles t = tiles_on(on(BaseShape::stairs, Projection::orthographic, 4));
  REQUIRE(t.tiles.size() == 4);
  for (std::size_t k = 0; k < 4; ++k) {
    CHECK_THAT(t.tiles[k].area_mm2(), WithinRel(100.0 * 20, 1e-12));
    CHECK_THAT(t.tiles[k].depth_mm(), WithinAbs(40 - 40.0 * static_cast<double>(k) / 3, 1e-12));  // the top is behind
    CHECK(t.tiles[k].turn_deg() == 0);
    const TileSolid solid = bare(t.tiles[k], 3);
    CHECK(solid.watertight);
    CHECK_THAT(solid.volume_mm3, WithinRel(100.0 * 20 * 3, 1e-6));
  }
}

TEST_CASE("ReliefTile.BareTilesHaveTheVolumeOfTheirRays") {
  for (const BaseShape base : {BaseShape::stairs, BaseShape::strips})
    for (const double turn : {0.0, 30.0}) {
      INFO("base " << static_cast<int>(base) << ", turned by " << turn);
      const Tiles t = tiles_on(on(base, Projection::perspective, 5, turn));
      REQUIRE(t.tiles.size() == 5);
      for (const ReliefTile& tile : t.tiles) {
        const TileSolid solid = bare(tile, 3);
        CHECK(solid.watertight);
        CHECK_THAT(solid.volume_mm3,
                   WithinRel(volume_between(tile.area_mm2(), tile.normal.dot(*tile.eye - tile.origin), 3), 2e-6));
        CHECK(signed_volume(in_place(solid, tile)) > 0);
        CHECK_THAT(signed_volume(in_place(solid, tile)), WithinRel(solid.volume_mm3, 1e-5));
      }
    }
}

TEST_CASE("ReliefTile.TheirPartsOfThePictureCoverThePlateOnce") {
  for (const BaseShape base : {BaseShape::stairs, BaseShape::strips})
    for (const Projection projection : {Projection::perspective, Projection::orthographic})
      for (const double turn : {0.0, -40.0, 90.0}) {
        const Tiles t = tiles_on(on(base, projection, 6, turn));
        double sum = 0;
        for (const ReliefTile& tile : t.tiles) {
          std::vector<Vec2> seen;
          for (const Vec2& corner : tile.outline) {
            const Vec3 p = tile.on_plane(corner);
            const double shrink = tile.eye ? tile.eye->z() / (tile.eye->z() - p.z()) : 1;
            seen.push_back(shrink * p.head<2>());
          }
          ReliefTile flat = tile;
          flat.outline = seen;
          CHECK(flat.area_mm2() > 0);
          sum += flat.area_mm2();
        }
        CHECK_THAT(sum, WithinRel(whole_plate.width_mm * whole_plate.height_mm, 1e-12));
      }
}

TEST_CASE("ReliefTile.StripsGoThroughTheirFolds") {
  const ReliefOptions options = on(BaseShape::strips, Projection::perspective, 5);
  const Tiles t = tiles_on(options);
  for (std::size_t k = 0; k + 1 < 5; ++k) {
    const double fold_t = t.bands.border()[k], fold_z = t.bands.depth(static_cast<int>(k), fold_t);
    for (const double y : {-30.0, 12.0})
      for (const ReliefTile& tile : {t.tiles[k], t.tiles[k + 1]})
        CHECK_THAT(tile.normal.dot(Vec3(100 * fold_t, y, -100 * fold_z) - tile.origin), WithinAbs(0, 1e-12));
    CHECK_THAT(std::acos(t.tiles[k].normal.dot(t.tiles[k + 1].normal)) * 180 / std::numbers::pi, WithinAbs(22.5, 1e-9));
    CHECK(t.tiles[k].on_plane(t.tiles[k].lower()).x() < t.tiles[k + 1].on_plane(t.tiles[k + 1].lower()).x());
  }
}

TEST_CASE("ReliefTile.StepsHiddenByNearerOnesAreLeftOut") {
  // From 250 mm: the first step ends at 20 mm, the second, 100 mm behind, at 25 mm, which is seen at 17.9 mm.
  ViewFrame frame;
  frame.kappa = 0.4;
  const BaseBands bands({0, 1, 2}, {0.2, 0.25}, 0);
  const std::vector<ReliefTile> tiles = relief_tiles(frame, bands, whole_plate, 100);
  REQUIRE(tiles.size() == 2);
  CHECK(tiles[0].band == 0);
  CHECK(tiles[1].band == 2);
}

TEST_CASE("ReliefTile.TheNumberIsSunkIntoTheBack") {
  const Tiles t = tiles_on(on(BaseShape::stairs, Projection::orthographic, 4));
  const TileSolid plain = bare(t.tiles[0], 3), numbered = bare(t.tiles[0], 3, 1);
  CHECK(numbered.numbered);
  CHECK(numbered.watertight);
  CHECK(vertex_components(Adjacency(numbered.mesh)).count == 1);
  // The figure 1 and an arrow, 7 mm high: strokes 1.12 mm wide and 0.6 mm deep.
  const double sunk = plain.volume_mm3 - numbered.volume_mm3;
  CHECK(sunk > 0.6 * 1.12 * 10);
  CHECK(sunk < 0.6 * 1.12 * 30);
  CHECK(bounding_box(numbered.mesh).size().isApprox(bounding_box(plain.mesh).size(), 1e-6));
  CHECK_FALSE(bare(tiles_on(on(BaseShape::stairs, Projection::orthographic, 40)).tiles[0], 3, 1).numbered);
}

}  // namespace
}  // namespace formwright
