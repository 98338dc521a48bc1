// SPDX-License-Identifier: GPL-3.0-or-later
// Reliefs on steps and strips in pieces: in their space, and whole from the viewpoint.
#include "relief/tiles/tiled_relief.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/measures.h"
#include "geometry/queries/ray_caster.h"
#include "geometry/test_meshes.h"
#include "relief/base/base_shape.h"
#include "relief/relief.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

ReliefOptions on(BaseShape base, Projection projection = Projection::perspective) {
  ReliefOptions options;
  options.width_mm = 100;
  options.thickness_mm = 2;
  options.carve_depth_mm = 1;
  options.margin_mm = 4;
  options.base = base;
  options.base_depth_mm = 40;
  options.base_steps = 5;
  options.pixel_mm = 1;
  options.projection = projection;
  return options;
}

struct Tiled {
  ViewFrame frame;
  BaseBands bands;
  Triangles F;
  Relief relief;
  PlateSize plate;
  std::vector<ReliefPiece> pieces;
};

Tiled tiled(const ReliefOptions& options) {
  Context context;
  ReliefSolver solver(test::icosphere(4), options, context);
  const ViewFrame& frame = solver.frame();
  const BaseBands bands = *base_bands(options, frame);
  Relief relief = solver.solve(options, BaseSurface(base_shape(options, frame), bands), context);
  const PlateSize plate{options.width_mm + 2 * options.margin_mm,
                        frame.image_height * options.width_mm + 2 * options.margin_mm};
  std::vector<ReliefPiece> pieces =
      tiled_relief(frame, bands, relief.pieces, plate, options, 1e-3 * options.thickness_mm, false, context);
  return {frame, bands, solver.F(), std::move(relief), plate, std::move(pieces)};
}

TEST_CASE("TiledRelief.EveryPieceIsClosedAndWithinItsSpace") {
  for (const BaseShape base : {BaseShape::stairs, BaseShape::strips})
    for (const Projection projection : {Projection::perspective, Projection::orthographic})
      for (const double turn : {0.0, 25.0}) {
        INFO("base " << static_cast<int>(base) << ", turned by " << turn);
        ReliefOptions options = on(base, projection);
        options.base_turn_deg = turn;
        const Tiled t = tiled(options);
        REQUIRE(t.pieces.size() == 5);
        double highest = -9;
        for (const auto& [tile, solid] : t.pieces) {
          const Adjacency adjacency(solid.mesh);
          CHECK(adjacency.is_closed());
          CHECK(vertex_components(adjacency).count == 1);
          CHECK_THAT(solid.mesh.V.col(2).minCoeff(), WithinAbs(0, 1e-4));
          CHECK(solid.mesh.V.col(2).maxCoeff() <= 3 + 1 + 2 + 1e-4);
          highest = std::max(highest, solid.mesh.V.col(2).maxCoeff());
          // Each corner lies within the planes through the viewpoint and the tile's edges.
          const TriangleMesh placed = in_place(solid, tile);
          for (Eigen::Index i = 0; i < placed.V.rows(); ++i) {
            const Vec3 p = placed.V.row(i).transpose();
            const double height = tile.normal.dot(p - tile.origin);
            const Vec3 back = tile.towards_eye(p), foot = p - back * (height / tile.normal.dot(back));
            const Vec2 place((foot - tile.origin).dot(tile.right), (foot - tile.origin).dot(tile.up));
            for (std::size_t k = 0; k < tile.outline.size(); ++k) {
              const Vec2 edge = tile.outline[(k + 1) % tile.outline.size()] - tile.outline[k];
              const Vec2 off = place - tile.outline[k];
              REQUIRE((edge.x() * off.y() - edge.y() * off.x()) / edge.norm() > -1e-4);
            }
          }
        }
        CHECK_THAT(highest, WithinAbs(6, 1e-4));
      }
}

/// Share of the rays through the picture at which pieces and the surface in one piece are not both met or both missed,
/// and the largest distance from the piece's own surface where both are met.
struct Seen {
  double differs = 0, off_mm = 0;
};

Seen compared(const Tiled& t, const ReliefOptions& options) {
  TriangleMesh all;
  for (const ReliefPiece& piece : t.pieces) {
    const TriangleMesh placed = in_place(piece.solid, piece.tile);
    const Eigen::Index v = all.V.rows(), f = all.F.rows();
    all.V.conservativeResize(v + placed.V.rows(), 3);
    all.V.bottomRows(placed.V.rows()) = placed.V;
    all.F.conservativeResize(f + placed.F.rows(), 3);
    all.F.bottomRows(placed.F.rows()) = placed.F.array() + static_cast<int>(v);
  }
  const TriangleMesh whole{to_scene(t.relief.seen, options.width_mm), t.F};
  const TriangleMesh cut{to_scene(t.relief.pieces.V, options.width_mm), t.relief.pieces.F};
  const RayCaster solids(all), surface(whole), parts(cut);
  const Vec3 eye = *t.pieces.front().tile.eye;
  int rays = 0, differing = 0;
  Seen seen;
  const int across = 200;
  for (int row = 0; row < across; ++row)
    for (int column = 0; column < across; ++column) {
      const Vec3 through(t.plate.width_mm * ((column + 0.37) / across - 0.5),
                         t.plate.height_mm * ((row + 0.41) / across - 0.5), 0);
      const Vec3 ray = (through - eye).normalized();
      const auto whole_hit = surface.first_hit(eye, ray, 0, 5 * eye.z()),
                 part_hit = parts.first_hit(eye, ray, 0, 5 * eye.z()),
                 solid_hit = solids.first_hit(eye, ray, 0, 5 * eye.z());
      ++rays;
      REQUIRE(solid_hit.has_value());  // no gap between the pieces, nor at their ends
      if (whole_hit.has_value() != part_hit.has_value()) {
        ++differing;
        continue;
      }
      if (!whole_hit) continue;
      const double off = std::abs(part_hit->distance - solid_hit->distance);
      if (off > 0.25) ++differing;
      else seen.off_mm = std::max(seen.off_mm, off);
    }
  seen.differs = static_cast<double>(differing) / rays;
  return seen;
}

TEST_CASE("TiledRelief.ThePictureFromTheViewpointIsThatOfTheSurfaceInOnePiece") {
  // What differs lies along the silhouette, in a strip of the width of a pixel.
  for (const BaseShape base : {BaseShape::stairs, BaseShape::strips}) {
    double before = 1;
    for (const double pixel : {2.0, 1.0, 0.5}) {
      ReliefOptions options = on(base);
      options.pixel_mm = pixel;
      const Seen seen = compared(tiled(options), options);
      INFO("base " << static_cast<int>(base) << ", pixel " << pixel << ": differs at " << seen.differs << ", off by "
                   << seen.off_mm);
      CHECK(seen.differs < 0.65 * before);
      before = seen.differs;
    }
    CHECK(before < 0.01);
  }
}

TEST_CASE("TiledRelief.VolumesConvergeWithThePixels") {
  for (const BaseShape base : {BaseShape::stairs, BaseShape::strips}) {
    std::vector<double> volumes;
    for (const double pixel : {2.0, 1.0, 0.5, 0.25, 0.125}) {
      ReliefOptions options = on(base);
      options.pixel_mm = pixel;
      double sum = 0;
      for (const ReliefPiece& piece : tiled(options).pieces) sum += piece.solid.volume_mm3;
      volumes.push_back(sum);
    }
    const double finest = volumes.back(), coarse = std::abs(volumes[0] - finest), fine = std::abs(volumes[3] - finest);
    INFO("base " << static_cast<int>(base) << ": errors " << coarse << " and " << fine);
    // At least order 1 from 2 mm to 0.25 mm: the silhouette is a step, the rest is smooth.
    CHECK(fine < coarse / 8);
    CHECK(fine < 1e-3 * finest);
  }
}

TEST_CASE("TiledRelief.PiecesOfStairsFillTheJointSolid") {
  // Straight on, the joint solid is the pieces and below each the step down to the lowest plate.
  ReliefOptions options = on(BaseShape::stairs, Projection::orthographic);
  options.pixel_mm = 0.5;
  const Tiled t = tiled(options);
  double sum = 0;
  for (const auto& [tile, solid] : t.pieces) sum += solid.volume_mm3 + tile.area_mm2() * (40 - tile.depth_mm());
  Context context;
  const BaseSurface base(base_shape(options, t.frame), t.bands);
  const AllowedSpace space{base, options.thickness_mm, options.carve_depth_mm};
  const HeightMap map = make_height_map({t.relief.pieces.V, t.relief.pieces.F, &t.relief.pieces.band}, options.width_mm,
                                        t.plate, options.pixel_mm, space, context);
  // The grid of the joint solid has ragged borders between steps, half a pixel of a riser of 10 mm at each of four.
  const double ragged = 4 * 0.5 * map.pitch_y_mm * t.plate.width_mm * 10;
  CHECK_THAT(signed_volume(make_solid(map, options.plate_mm, 2e-3, context)), WithinAbs(sum, ragged));
}

TEST_CASE("TiledRelief.OneBandIsThePlate") {
  ReliefOptions options = on(BaseShape::flat, Projection::orthographic);
  options.carve_depth_mm = 0;
  Context context;
  ReliefSolver solver(test::icosphere(4), options, context);
  const BaseBands one({0.0}, {}, 0);
  const Relief relief = solver.solve(options, context);
  ReliefPieces all{relief.moved, solver.F(), std::vector<int>(static_cast<std::size_t>(solver.F().rows()), 0),
                   {},           {},         {}};
  const PlateSize plate{108, solver.frame().image_height * 100 + 8};
  const auto pieces = tiled_relief(solver.frame(), one, all, plate, options, 1e-9, false, context);
  REQUIRE(pieces.size() == 1);
  const HeightMap map = make_height_map(relief.moved, solver.F(), 100, plate, options.pixel_mm, 2, context);
  const TriangleMesh joint = make_solid(map, options.plate_mm, 1e-9, context);
  CHECK_THAT(pieces[0].solid.volume_mm3, WithinRel(signed_volume(joint), 1e-4));
  CHECK(bounding_box(pieces[0].solid.mesh).size().isApprox(bounding_box(joint).size(), 1e-4));
}

}  // namespace
}  // namespace formwright
