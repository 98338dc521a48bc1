// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/zippable_design.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "base/error.h"
#include "base/json.h"
#include "geometry/measures.h"
#include "zippable/design_files.h"
#include "zippable/zippable_shapes.h"

namespace formwright {
namespace {

ZippableDesign design(std::string_view sample, const ZippableOptions& options, const std::vector<Vec3>& tips = {}) {
  Context context;
  return design_zippable(make_sample(sample, 2500, context).mesh, tips, options, context);
}

TEST(ZippableDesign, ScalesBeforeEverythingElse) {
  ZippableOptions options;
  const ZippableDesign small = design("heart", options);
  const double scale = 3;
  Context context;
  options.size_mm = scale * bounding_box(make_sample("heart", 2500, context).mesh).size().maxCoeff();
  options.width_mm *= scale;
  const ZippableDesign large = design("heart", options);
  EXPECT_NEAR(large.scale, scale, 1e-12);
  EXPECT_NEAR(large.ribbon.zipper_mm / small.ribbon.zipper_mm, large.scale, 1e-3);
  EXPECT_NEAR(large.ribbon_to_model.mean / small.ribbon_to_model.mean, large.scale, 0.02 * large.scale);
}

TEST(ZippableDesign, NarrowerRibbonsAreCloserAndLonger) {
  ZippableOptions options;
  double error = 1e9, length = 0;
  for (const double width : {24.0, 12.0, 6.0}) {
    options.width_mm = width;
    const ZippableDesign d = design("t_shape", options);
    EXPECT_LT(d.ribbon_to_model.mean, error);
    EXPECT_GT(d.ribbon.zipper_mm, length);
    error = d.ribbon_to_model.mean, length = d.ribbon.zipper_mm;
  }
}

TEST(ZippableDesign, FollowsGivenPunctures) {
  const ZippableDesign d = design("star", {}, {{0, 100, 0}, {0, 0, 0}});
  EXPECT_EQ(d.proposal.segmentation.part_count(), 1);
  EXPECT_EQ(d.curve.fermat_spirals, 0);
}

TEST(ZippableDesign, RefusesInOneSentence) {
  const auto refused = [](const ZippableOptions& options, const std::vector<Vec3>& tips = {}) {
    try {
      design("heart", options, tips);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::invalid_input);
      return error.where();
    }
    return std::string("nothing");
  };
  ZippableOptions options;
  options.width_mm = 80;
  EXPECT_EQ(refused(options), "width_mm");
  options.width_mm = 0.1;
  options.size_mm = 1000;
  EXPECT_EQ(refused(options), "width_mm");
  options = {};
  options.traversal = 5000;
  EXPECT_EQ(refused(options), "traversal");
  EXPECT_EQ(refused({}, {{0, 0, 0}}), "segments");
  EXPECT_EQ(refused({}, {{0, 0, 0}, {0, 0, 0}}), "segments");
  Context context;
  const TriangleMesh ball = test::icosphere(2);
  EXPECT_THROW(design_zippable(test::joined(ball, test::moved(ball, Vec3(3, 0, 0))), {}, ZippableOptions{}, context), Error);
}

TEST(ZippableFiles, TellTheDesign) {
  ZippableOptions options;
  const ZippableDesign d = design("t_shape", options);
  const Json json = Json::parse(as_text(write_design_json(d)));
  EXPECT_EQ(json["parts"].size(), 3u);
  EXPECT_EQ(json["ribbon"]["boundary"].size(), d.ribbon.boundary.size());
  EXPECT_EQ(json["ribbon"]["triangles"].size(), static_cast<std::size_t>(d.ribbon.F.rows()));
  // The outline of the SVG is as long as both sides of the zipper and the openings together, in mm.
  const Bytes svg_bytes = write_ribbon_svg(d);
  const std::string svg(as_text(svg_bytes));
  double zipper = 0;
  const std::size_t begin = svg.find(" d=\"", svg.find("id=\"zipper\"")) + 4, end = svg.find('"', begin);
  for (std::size_t at = begin; at < end;) {
    double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    int used = 0;
    ASSERT_EQ(std::sscanf(svg.c_str() + at, "M%lf %lfL%lf %lf%n", &x0, &y0, &x1, &y1, &used), 4);
    zipper += std::hypot(x1 - x0, y1 - y0);
    at += static_cast<std::size_t>(used);
  }
  EXPECT_NEAR(zipper, 2 * d.ribbon.zipper_mm, 1e-3 * static_cast<double>(d.ribbon.boundary.size()));
}

TEST(ZippableFiles, ReadSegmentsOrSayWhatIsWrong) {
  const auto points = read_segments(to_bytes(R"({"punctures": [[1, 2, 3], [4, 5.5, -6]]})"));
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[1], Vec3(4, 5.5, -6));
  for (const char* wrong : {"", "[]", "{}", R"({"punctures": 3})", R"({"punctures": [[1, 2]]})", R"({"punctures": [[1, 2, "x"]]})", R"({"punctures": [[1, 2, 1e99]]})",
                            R"({"loops": []})"}) {
    try {
      read_segments(to_bytes(wrong));
      FAIL() << "accepted " << wrong;
    } catch (const Error& error) {
      EXPECT_EQ(error.where(), "segments");
      EXPECT_EQ(std::string(error.what()).back(), '.');
    }
  }
}

}  // namespace
}  // namespace formwright
