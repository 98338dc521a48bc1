// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>
#include <numbers>
#include <string_view>

#include "geometry/mesh/adjacency.h"
#include "geometry/queries/point_distance.h"
#include "geometry/samples/samples.h"
#include "zippable/strips/band_network.h"
#include "zippable/strips/strip_model.h"
#include "zippable/zippable_shapes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

std::vector<int> no_limbs(const TriangleMesh& mesh) { return std::vector<int>(std::size_t(mesh.face_count()), 0); }

double area_mm2(const TriangleMesh& mesh) {
  double area = 0;
  for (int f = 0; f < mesh.face_count(); ++f) {
    const Vec3 a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)), c = mesh.V.row(mesh.F(f, 2));
    area += (b - a).cross(c - a).norm() / 2;
  }
  return area;
}

TEST_CASE("Bands.OfACylinderAreRingsOfEqualWidth") {
  Context context;
  const TriangleMesh mesh = test::cylinder_side(20, 80, 48, 40);
  const Bands bands = distance_bands(mesh, no_limbs(mesh), 50, 10, context);
  CHECK(bands.part_count == 1);
  CHECK_THAT(area_mm2(bands.mesh), WithinAbs(area_mm2(mesh), 1e-6));
  // Distance to the nearer opening: three rings from either end, and one in the middle over both.
  CHECK(bands.band_count == 7);
  const BandNetwork network = band_network(bands, 4);
  for (const auto& loops : network.loops) CHECK(loops.size() == 2u);
}

TEST_CASE("Bands.PartsAreThoseOfFeatureLines") {
  Context context;
  // An octahedron's faces stand at 70.5 degrees to each other.
  TriangleMesh mesh;
  mesh.V.resize(6, 3);
  mesh.V << 30, 0, 0, -30, 0, 0, 0, 30, 0, 0, -30, 0, 0, 0, 30, 0, 0, -30;
  mesh.F.resize(8, 3);
  mesh.F << 0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5;
  CHECK(distance_bands(mesh, no_limbs(mesh), 50, 5, context).part_count == 8);
  CHECK(distance_bands(mesh, no_limbs(mesh), 80, 5, context).part_count == 1);
}

/// Pieces of an octahedron are its eight faces as they are.
TEST_CASE("Strips.FlatFacesAreTheirOwnPieces") {
  Context context;
  TriangleMesh mesh;
  mesh.V.resize(6, 3);
  mesh.V << 30, 0, 0, -30, 0, 0, 0, 30, 0, 0, -30, 0, 0, 0, 30, 0, 0, -30;
  mesh.F.resize(8, 3);
  mesh.F << 0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5;
  StripOptions options;
  options.width_mm = 20;
  const StripModel model = make_strips(mesh, no_limbs(mesh), options, context);
  CHECK(model.pieces.size() == 8u);
  CHECK_THAT(area_mm2(model.formed), WithinAbs(area_mm2(mesh), 1e-6 * area_mm2(mesh)));
  std::vector<Polygon> outlines;
  for (const StripPiece& piece : model.pieces) outlines.push_back(piece.outline_mm);
  const PieceFigures figures = piece_figures(outlines);
  const double side = 30 * std::numbers::sqrt2;
  CHECK_THAT(figures.cut_length_mm, WithinAbs(8 * 3 * side, 1e-6));
  CHECK_THAT(figures.narrowest_mm, WithinAbs(2 * (std::sqrt(3) / 4 * side * side) / (3 * side), 1e-9));
}

TEST_CASE("Strips.OfSamplesAreFlatWholeAndOffThemselves") {
  for (const char* sample : {"star", "heart", "t_shape", "octopus", "cat"}) {
    Context context;
    TriangleMesh mesh = make_sample(sample, 2500, context).mesh;
    StripOptions options;
    options.width_mm = 14;
    const StripModel model = make_strips(mesh, no_limbs(mesh), options, context);
    {
      INFO(sample);
      CHECK(model.isometry_error < 1e-9);
      // The cat is of genus one, which a note says where a band holds the handle.
      CHECK(model.notes.size() == (std::string_view(sample) == "cat" ? 1u : 0u));
    }
    REQUIRE_FALSE(model.pieces.empty());
    for (const StripPiece& piece : model.pieces) {
      // Disjoint triangles that fill the outline, so that it is crossed by nothing.
      double area = 0;
      for (Eigen::Index f = 0; f < piece.F.rows(); ++f) {
        const auto corners = [&](Eigen::Index g) {
          return std::array<Vec2, 3>{piece.flat_mm[piece.F(g, 0)], piece.flat_mm[piece.F(g, 1)],
                                     piece.flat_mm[piece.F(g, 2)]};
        };
        const auto c = corners(f);
        area += signed_area_mm2({c[0], c[1], c[2]});
        for (Eigen::Index g = 0; g < f; ++g) {
          INFO(sample);
          CHECK_FALSE(triangles_overlap(c, corners(g), 1e-6));
        }
      }
      INFO(sample);
      CHECK_THAT(signed_area_mm2(piece.outline_mm), WithinAbs(area, 1e-6 * area + 1e-9));
    }
    const double there = surface_distance(model.formed, PointDistance(mesh), 3, context).mean,
                 back = surface_distance(mesh, PointDistance(model.formed), 3, context).mean;
    INFO(sample);
    CHECK(std::max(there, back) < 0.1 * options.width_mm);
  }
}

TEST_CASE("Strips.NarrowerOnesComeNearerToASphere") {
  Context context;
  const TriangleMesh mesh = test::turned(96, 60, [](double t) {
    const double angle = std::numbers::pi * (0.08 + 0.84 * t);
    return Vec2(50 * std::sin(angle), -50 * std::cos(angle));
  });
  double before = 0;
  for (const double width : {24.0, 12.0}) {
    StripOptions options;
    options.width_mm = width;
    const StripModel model = make_strips(mesh, no_limbs(mesh), options, context);
    const double distance = surface_distance(model.formed, PointDistance(mesh), 1, context).mean;
    if (before > 0) {
      CHECK(std::log2(before / distance) > 1.5);
    }  // second order
    before = distance;
  }
}

}  // namespace
}  // namespace formwright
