// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/zippable_design.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>
#include <string>

#include "base/error.h"
#include "base/data/json.h"
#include "geometry/mesh/measures.h"
#include "zippable/design_files.h"
#include "zippable/zippable_shapes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

struct Designed {
  ParameterisedModel model;
  ZippableDesign design;
};

Designed design(std::string_view sample, const ZippableOptions& options, const ZippableParts& parts = {}) {
  Context context;
  Designed d{parameterise_model(make_sample(sample, 2500, context).mesh, parts, options, context), {}};
  d.design = design_zippable(d.model, options, context);
  return d;
}

TEST_CASE("ZippableDesign.ScalesBeforeEverythingElse") {
  ZippableOptions options;
  const auto [small_model, small] = design("heart", options);
  const double scale = 3;
  Context context;
  options.size_mm = scale * bounding_box(make_sample("heart", 2500, context).mesh).size().maxCoeff();
  options.width_mm *= scale;
  const auto [large_model, large] = design("heart", options);
  CHECK_THAT(large_model.scale, WithinAbs(scale, 1e-12));
  CHECK_THAT(large.ribbon.zipper_mm / small.ribbon.zipper_mm, WithinAbs(large_model.scale, 1e-3));
  CHECK_THAT(large.ribbon_to_model->mean / small.ribbon_to_model->mean,
             WithinAbs(large_model.scale, 0.02 * large_model.scale));
}

TEST_CASE("ZippableDesign.NarrowerRibbonsAreCloserAndLonger") {
  ZippableOptions options;
  double error = 1e9, length = 0;
  for (const double width : {24.0, 12.0, 6.0}) {
    options.width_mm = width;
    const ZippableDesign d = design("t_shape", options).design;
    CHECK(d.ribbon_to_model->mean < error);
    CHECK(d.ribbon.zipper_mm > length);
    error = d.ribbon_to_model->mean, length = d.ribbon.zipper_mm;
  }
}

TEST_CASE("ZippableDesign.FollowsGivenPunctures") {
  const Designed d = design("star", {}, {{{0, 100, 0}, {0, 0, 0}}, {}});
  CHECK(d.model.proposal.segmentation.part_count() == 1);
  CHECK(d.design.curve.fermat_spirals == 0);
}

TEST_CASE("ZippableDesign.FollowsDrawnCurves") {
  // A ball cut along its equator, then one half into quarters: the borders come out smooth, less than an edge from the
  // great circles.
  Context context;
  TriangleMesh ball = test::icosphere(5);
  ball.V *= 50;
  ZippableParts parts;
  DrawnCurve equator{{}, true}, meridian{{}, false};
  for (int k = 0; k < 8; ++k)
    equator.points.emplace_back(50 * std::cos(k * std::numbers::pi / 4), 50 * std::sin(k * std::numbers::pi / 4), 0);
  for (int k = 0; k <= 4; ++k)
    meridian.points.emplace_back(50 * std::cos(k * std::numbers::pi / 4), 0, 50 * std::sin(k * std::numbers::pi / 4));
  parts.curves = {equator};
  ZippableOptions options;
  options.width_mm = 10;
  const ParameterisedModel halves = parameterise_model(ball, parts, options, context);
  const Segmentation& two = halves.proposal.segmentation;
  REQUIRE(two.part_count() == 2);
  REQUIRE(two.interfaces.size() == 1u);
  CHECK(two.interfaces[0].is_closed());
  for (const int v : two.interfaces[0].vertices) CHECK(std::abs(two.mesh.V(v, 2)) < 0.8 * mean_edge_length(ball));
  CHECK_THAT(walk_length_mm(two.mesh, two.interfaces[0].vertices, false),
             WithinAbs(2 * std::numbers::pi * 50, 0.02 * 2 * std::numbers::pi * 50));
  CHECK(design_zippable(halves, options, context).ribbon.opening_arcs == 2);
  parts.curves.push_back(meridian);
  const ParameterisedModel thirds = parameterise_model(ball, parts, options, context);
  CHECK(thirds.proposal.segmentation.part_count() == 3);
  CHECK(thirds.proposal.segmentation.interfaces.size() == 3u);
  CHECK(design_zippable(thirds, options, context).curve.fermat_spirals == 1);
  // A curve that ends nowhere divides nothing.
  parts.curves = {meridian};
  CHECK_THROWS_AS(parameterise_model(ball, parts, options, context), Error);
}

TEST_CASE("ZippableDesign.IsTheSameFromAKeptParameterisation") {
  Context context;
  ZippableOptions options, other;
  other.windings = 3.5, other.traversal = 2;
  CHECK(parameterisation_key(options) == parameterisation_key(other));
  other.width_mm = 10;  // and so the punctures
  CHECK(parameterisation_key(options) != parameterisation_key(other));
  options.windings = 3.5, options.traversal = 2;
  const ZippableDesign fresh = design("t_shape", options).design;
  const Designed kept = design("t_shape", {});
  CHECK(design_zippable(kept.model, options, context).ribbon.zipper_mm == fresh.ribbon.zipper_mm);
}

TEST_CASE("ZippableDesign.TakesWindingsPartByPart") {
  Context context;
  const Designed given = design("t_shape", {});
  const std::vector<double>& automatic = given.design.curve.windings;
  REQUIRE(automatic.size() == 3u);
  ZippableOptions options;
  options.part_windings = "0, 4.25";
  const ZippableDesign own = design_zippable(given.model, options, context);
  CHECK(own.curve.windings == std::vector<double>{automatic[0], 4.25, automatic[2]});
  // All of them are what one number for all is.
  options.part_windings = "3.5 3.5 3.5";
  ZippableOptions all;
  all.windings = 3.5;
  CHECK(design_zippable(given.model, options, context).ribbon.zipper_mm ==
        design_zippable(given.model, all, context).ribbon.zipper_mm);
  // The same parts on the same parameterisation, measured or not.
  CHECK(parameterisation_key(options) == parameterisation_key({}));
  options.measure_distances = false;
  const ZippableDesign quick = design_zippable(given.model, options, context);
  CHECK(quick.seconds_distance == 0);
  CHECK(quick.ribbon.zipper_mm == design_zippable(given.model, all, context).ribbon.zipper_mm);
}

TEST_CASE("ZippableDesign.RefusesInOneSentence") {
  const auto refused = [](const ZippableOptions& options, const std::vector<Vec3>& tips = {}) {
    try {
      design("heart", options, {tips, {}});
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::invalid_input);
      return error.where();
    }
    return std::string("nothing");
  };
  ZippableOptions options;
  options.width_mm = 80;
  CHECK(refused(options) == "width_mm");
  options.width_mm = 0.1;
  options.size_mm = 1000;
  CHECK(refused(options) == "width_mm");
  options = {};
  options.traversal = 5000;
  CHECK(refused(options) == "traversal");
  for (const char* wrong : {"a", "1 2 3 4 5 6 7 8 9 10 11 12", "-1", "1001"}) {
    options = {};
    options.part_windings = wrong;
    INFO(wrong);
    CHECK(refused(options) == "part_windings");
  }
  CHECK(refused({}, {{0, 0, 0}}) == "segments");
  CHECK(refused({}, {{0, 0, 0}, {0, 0, 0}}) == "segments");
  Context context;
  const TriangleMesh ball = test::icosphere(2);
  CHECK_THROWS_AS(
      parameterise_model(test::joined(ball, test::moved(ball, Vec3(3, 0, 0))), {}, ZippableOptions{}, context), Error);
}

TEST_CASE("ZippableFiles.TellTheDesign") {
  ZippableOptions options;
  const auto [model, d] = design("t_shape", options);
  const Bytes text = write_design_json(model, d);
  const Json json = Json::parse(as_text(text));
  CHECK(json["parts"].size() == 3u);
  CHECK(json["ribbon"]["boundary"].size() == d.ribbon.boundary.size());
  CHECK(json["ribbon"]["triangles"].size() == static_cast<std::size_t>(d.ribbon.F.rows()));
  // The outline of the SVG is as long as both sides of the zipper and the openings together, in mm.
  const Bytes svg_bytes = write_ribbon_svg(d);
  const std::string svg(as_text(svg_bytes));
  double zipper = 0;
  const std::size_t begin = svg.find(" d=\"", svg.find("id=\"zipper\"")) + 4, end = svg.find('"', begin);
  for (std::size_t at = begin; at < end;) {
    double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    int used = 0;
    REQUIRE(std::sscanf(svg.c_str() + at, "M%lf %lfL%lf %lf%n", &x0, &y0, &x1, &y1, &used) == 4);
    zipper += std::hypot(x1 - x0, y1 - y0);
    at += static_cast<std::size_t>(used);
  }
  CHECK_THAT(zipper, WithinAbs(2 * d.ribbon.zipper_mm, 1e-3 * static_cast<double>(d.ribbon.boundary.size())));
}

TEST_CASE("ZippableFiles.ReadSegmentsOrSayWhatIsWrong") {
  const ZippableParts parts = read_segments(to_bytes(
      R"({"punctures": [[1, 2, 3], [4, 5.5, -6]], "loops": [[[0, 0, 0], [1, 0, 0], [0, 1, 0]]], "lines": [[[0, 0, 1], [0, 0, 2]]]})"));
  REQUIRE(parts.punctures.size() == 2u);
  CHECK(parts.punctures[1] == Vec3(4, 5.5, -6));
  REQUIRE(parts.curves.size() == 2u);
  CHECK((parts.curves[0].closed && !parts.curves[1].closed));
  for (const char* wrong :
       {"", "[]", "{}", R"({"punctures": 3})", R"({"punctures": [[1, 2]]})", R"({"punctures": [[1, 2, "x"]]})",
        R"({"punctures": [[1, 2, 1e99]]})", R"({"loops": []})", R"({"loops": [[1, 2, 3]]})", R"({"rings": []})"})
    test::expect_segments_refused(wrong);
}

}  // namespace
}  // namespace formwright
