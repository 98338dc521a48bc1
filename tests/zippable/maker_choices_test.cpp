// SPDX-License-Identifier: GPL-3.0-or-later
// What a maker's own division may say: punctures that are cuts, where the zipper begins and ends, parts that are only
// checked.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>

#include "base/error.h"
#include "base/data/json.h"
#include "geometry/mesh/measures.h"
#include "zippable/design_files.h"
#include "zippable/parts/slit.h"
#include "zippable/zippable_shapes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

using std::numbers::pi;

TriangleMesh ball(int levels = 4) {
  TriangleMesh mesh = test::icosphere(levels);
  mesh.V *= 50;
  return mesh;
}

OpenedSurface whole(TriangleMesh mesh) {
  OpenedSurface surface;
  for (int v = 0; v < mesh.vertex_count(); ++v) surface.source_of.push_back(v);
  surface.mesh = std::move(mesh);
  return surface;
}

double length_mm(const std::vector<Vec3>& line) {
  double length = 0;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) length += (line[i + 1] - line[i]).norm();
  return length;
}

std::vector<Vec3> meridian(double from_rad, double to_rad, int count) {
  std::vector<Vec3> points;
  for (int k = 0; k < count; ++k) {
    const double u = from_rad + (to_rad - from_rad) * k / (count - 1);
    points.emplace_back(50 * std::sin(u), 0, 50 * std::cos(u));
  }
  return points;
}

TEST_CASE("Slit.IsOneOpeningAlongItsPath") {
  Context context;
  for (const int levels : {3, 4, 5}) {
    OpenedSurface surface = whole(ball(levels));
    const double area = surface_area(surface.mesh), edge = mean_edge_length(surface.mesh);
    const auto cuts = cut_slits(surface, {meridian(-0.6, 0.6, 2)}, context);
    REQUIRE(cuts.size() == 1u);
    const Adjacency adjacency(surface.mesh);
    CHECK(adjacency.is_manifold());
    CHECK(euler_characteristic(adjacency) == 1);
    const auto loops = boundary_loops(adjacency);
    REQUIRE(loops.size() == 1u);
    CHECK(loops[0].size() == 2 * (cuts[0].size() - 1));
    CHECK_THAT(surface_area(surface.mesh), WithinAbs(area, 1e-9 * area));
    CHECK(surface.source_of.size() == static_cast<std::size_t>(surface.mesh.vertex_count()));
    // A great circle's arc of 1.2 rad, up to an edge at either end.
    for (const Vec3& point : cuts[0]) CHECK(std::abs(point.y()) < 0.2 * edge);
    CHECK_THAT(length_mm(cuts[0]), WithinAbs(60, 2.2 * edge));
  }
}

TEST_CASE("Slit.MayBeCurved") {
  // Around three quarters of a circle of latitude.
  Context context;
  std::vector<Vec3> points;
  for (int k = 0; k <= 12; ++k)
    points.emplace_back(50 * std::sin(0.5) * std::cos(pi * k / 8), 50 * std::sin(0.5) * std::sin(pi * k / 8),
                        50 * std::cos(0.5));
  OpenedSurface surface = whole(ball(5));
  const auto cuts = cut_slits(surface, {points}, context);
  const double edge = mean_edge_length(surface.mesh);
  for (const Vec3& point : cuts[0]) CHECK_THAT(std::acos(point.z() / point.norm()), WithinAbs(0.5, 0.4 * edge / 50));
  CHECK_THAT(length_mm(cuts[0]), WithinAbs(1.5 * pi * 50 * std::sin(0.5), 0.05 * 1.5 * pi * 50 * std::sin(0.5) + edge));
  CHECK(boundary_loops(Adjacency(surface.mesh)).size() == 1u);
}

TEST_CASE("Slit.SaysWhatIsWrongWithAPath") {
  Context context;
  const auto refused = [&](const std::vector<std::vector<Vec3>>& paths) {
    OpenedSurface surface = whole(ball());
    try {
      cut_slits(surface, paths, context);
    } catch (const Error& error) {
      CHECK(error.where() == "segments");
      return std::string(error.what());
    }
    return std::string();
  };
  CHECK(refused({{{0, 0, 50}, {0, 0, 50}}}).find("Cut 1 of the punctures has all its points in one place") !=
        std::string::npos);
  CHECK(refused({{{0, 0, 50}, {0.5, 0, 50}}}).find("too short") != std::string::npos);
  // One across the other.
  CHECK(refused({meridian(-0.6, 0.6, 2), {{0, -20, 46}, {0, 20, 46}}}).find("Cut 2") != std::string::npos);
}

TEST_CASE("MakerChoices.ACutIsAnOpeningLikeAHole") {
  // A ball with a hole below and a cut above: one cylinder whose upper line is the cut, and a ribbon that unfolds.
  Context context;
  ZippableOptions options;
  options.width_mm = 12;
  ZippableParts parts;
  parts.punctures = {{0, 0, -50}};
  parts.cuts = {meridian(-0.5, 0.5, 3)};
  const ParameterisedModel model = parameterise_model(ball(), parts, options, context);
  CHECK(model.proposal.segmentation.part_count() == 1);
  REQUIRE(model.proposal.slits.size() == 1u);
  CHECK(constraint_residual_mm(model.proposal.segmentation, model.parameterisation) < 1e-10);
  const ZippableDesign design = design_zippable(model, options, context);
  CHECK(design.ribbon.isometry_error < 1e-9);
  CHECK(design.ribbon.opening_arcs == 2);
  const Json json = Json::parse(as_text(write_design_json(model, design)));
  REQUIRE(json["punctures"].size() == 2u);
  CHECK(json["punctures"][1]["path_mm"].size() == model.proposal.slits[0].size());
  // With a border drawn around, it opens the part that it lies in.
  DrawnCurve equator{{}, true, {}};
  for (int k = 0; k < 8; ++k) equator.points.emplace_back(50 * std::cos(k * pi / 4), 50 * std::sin(k * pi / 4), 0);
  parts.curves = {equator};
  const ParameterisedModel halves = parameterise_model(ball(), parts, options, context);
  CHECK(halves.proposal.segmentation.part_count() == 2);
  CHECK(halves.proposal.punctures.size() == 1u);
  CHECK(design_zippable(halves, options, context).ribbon.isometry_error < 1e-9);
  // A single one makes no cylinder.
  ZippableParts single;
  single.cuts = parts.cuts;
  CHECK_THROWS_AS(parameterise_model(ball(), single, options, context), Error);
}

/// A ball's northern half, and its southern half in two.
ZippableParts three_parts() {
  ZippableParts parts;
  DrawnCurve equator{{}, true, {}}, below{{}, false, {}};
  for (int k = 0; k < 8; ++k) equator.points.emplace_back(50 * std::cos(k * pi / 4), 50 * std::sin(k * pi / 4), 0);
  for (int k = 0; k <= 4; ++k) below.points.emplace_back(50 * std::cos(k * pi / 4), 0, -50 * std::sin(k * pi / 4));
  parts.curves = {equator, below};
  return parts;
}

TEST_CASE("MakerChoices.TheZipperBeginsAndEndsInThePartsOfGivenPoints") {
  Context context;
  ZippableOptions options;
  options.width_mm = 12;
  options.measure_distances = false;
  const std::vector<Vec3> places{{0, 0, 50}, {0, 40, -30}, {0, -40, -30}};
  for (const int first : {0, 1, 2}) {
    ZippableParts parts = three_parts();
    parts.start = places[first];
    parts.end = places[(first + 1) % 3];
    const ParameterisedModel model = parameterise_model(ball(), parts, options, context);
    const ZippableDesign design = design_zippable(model, options, context);
    const std::vector<int>& order = design.traversal.traversal.parts;
    CHECK(order.front() + 1 == model.start_part);
    CHECK(order.back() + 1 == model.end_part);
    CHECK(model.start_part != model.end_part);
    // A number given on top goes before the point.
    ZippableOptions other = options;
    other.start_part = model.end_part, other.end_part = model.start_part;
    CHECK(design_zippable(model, other, context).traversal.traversal.parts.front() + 1 == model.end_part);
  }
  ZippableParts same = three_parts();
  same.start = same.end = places[0];
  try {
    design_zippable(parameterise_model(ball(), same, options, context), options, context);
    FAIL();
  } catch (const Error& error) {
    CHECK(error.where() == "segments");
  }
}

TEST_CASE("MakerChoices.PartsAreCheckedWithoutMakingAnythingOfThem") {
  Context context;
  ZippableOptions options;
  options.width_mm = 12;
  options.check_parts = true;
  const ParameterisedModel good = divide_model(ball(), three_parts(), options, context);
  CHECK(good.proposal.segmentation.valid());
  const Json parts = Json::parse(as_text(write_parts_json(good)))["parts"];
  REQUIRE(parts.size() == 3u);
  for (const Json& part : parts) {
    CHECK(part["cylinder"]);
    CHECK(part["why_not"].is_null());
  }
  // A band between two circles has two borders and no opening: it is said, not refused, unless it is to become a
  // ribbon.
  ZippableParts band;
  for (const double z : {-20.0, 20.0}) {
    DrawnCurve circle{{}, true, {}};
    const double r = std::sqrt(2500 - z * z);
    for (int k = 0; k < 8; ++k) circle.points.emplace_back(r * std::cos(k * pi / 4), r * std::sin(k * pi / 4), z);
    band.curves.push_back(circle);
  }
  const ParameterisedModel checked = divide_model(ball(), band, options, context);
  REQUIRE(checked.proposal.segmentation.part_count() == 3);
  int cylinders = 0;
  const Json written = Json::parse(as_text(write_parts_json(checked)))["parts"];
  for (const Json& part : written) {
    cylinders += part["cylinder"].get<bool>();
    CHECK(part["why_not"].is_null() == part["cylinder"].get<bool>());
  }
  CHECK(cylinders == 2);
  options.check_parts = false;
  CHECK_THROWS_AS(divide_model(ball(), band, options, context), Error);
}

TEST_CASE("MakerChoices.AreReadFromSegments") {
  const ZippableParts parts = read_segments(to_bytes(
      R"({"punctures": [[1, 2, 3], [[0, 0, 1], [0, 1, 1], [1, 1, 1]]], "loops": [{"points": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "snap": true}],
          "lines": [[[0, 0, 1], [0, 0, 2]]], "start": [0, 0, 9], "end": [0, 0, -9]})"));
  CHECK(parts.punctures.size() == 1u);
  REQUIRE(parts.cuts.size() == 1u);
  CHECK(parts.cuts[0][2] == Vec3(1, 1, 1));
  CHECK(parts.curves[0].snap == true);
  CHECK_FALSE(parts.curves[1].snap.has_value());
  CHECK(*parts.start == Vec3(0, 0, 9));
  CHECK(*parts.end == Vec3(0, 0, -9));
  for (const char* wrong :
       {R"({"punctures": [[[0, 0, 1]]]})", R"({"punctures": [[[0, 0, 1], [1, 2]]]})", R"({"start": 1})",
        R"({"end": [1, 2]})", R"({"loops": [{"snap": true}]})", R"({"loops": [{"points": [[0, 0, 1]], "snap": 1}]})",
        R"({"loops": [{"points": [], "x": 1}]})"})
    test::expect_segments_refused(wrong);
}

}  // namespace
}  // namespace formwright
