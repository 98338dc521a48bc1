// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/svg/svg_reader.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <string>

#include "base/error.h"
#include "fabrication/planar/polygon.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

SvgDrawing read(const std::string& svg, const SvgReadOptions& options = {}) {
  return read_svg_drawing(as_bytes(svg), options, Context());
}

/// A drawing of 100 x 60 mm whose unit is the millimetre.
SvgDrawing read_body(const std::string& body, const SvgReadOptions& options = {}) {
  return read(
      "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='60mm' viewBox='0 0 100 60' fill='none' stroke='red'>" +
          body + "</svg>",
      options);
}

std::string refusal(const std::string& svg) {
  try {
    read(svg);
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::invalid_input);
    CHECK(error.where() == "drawing");
    return error.what();
  }
  FAIL_CHECK("was not refused: " << svg);
  return "";
}

/// Of both coordinates, y from the top.
void expect_points(const SvgDrawing& drawing, const std::vector<Vec2>& expected, double tolerance = 1e-6) {
  REQUIRE(drawing.sheet.paths.size() == 1u);
  const auto& points = drawing.sheet.paths[0].points_mm;
  REQUIRE(points.size() == expected.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    INFO(i);
    CHECK_THAT(points[i].x(), WithinAbs(expected[i].x(), tolerance));
    CHECK_THAT(drawing.sheet.height_mm - points[i].y(), WithinAbs(expected[i].y(), tolerance));
  }
}

TEST_CASE("SvgReader.EveryUnitIsItsMillimetres") {
  struct Case {
    std::string size;
    double mm;
  };
  for (const Case& c : {Case{"500mm", 500}, Case{"25cm", 250}, Case{"4in", 101.6}, Case{"72pt", 25.4},
                        Case{"6pc", 25.4}, Case{"96px", 25.4}, Case{"40Q", 10}}) {
    // With a viewBox the whole of it is that size, without one a unit is a px.
    const SvgDrawing boxed = read("<svg width='" + c.size + "' height='" + c.size +
                                  "' viewBox='0 0 2 2'><path stroke='red' d='M0 0L1 2'/></svg>");
    {
      INFO(c.size);
      CHECK_THAT(boxed.sheet.width_mm, WithinAbs(c.mm, 1e-9));
      CHECK_THAT(boxed.sheet.paths.at(0).points_mm[1].x(), WithinAbs(c.mm / 2, 1e-6));
      CHECK_THAT(boxed.sheet.paths.at(0).points_mm[1].y(), WithinAbs(0, 1e-6));
    }
    const SvgDrawing plain =
        read("<svg width='" + c.size + "' height='" + c.size + "'><path stroke='red' d='M0 0L96 0'/></svg>");
    {
      INFO(c.size);
      CHECK_THAT(plain.sheet.paths.at(0).points_mm[1].x(), WithinAbs(25.4, 1e-6));
    }
    // Lengths of shapes have units of their own.
    const SvgDrawing shape = read("<svg width='10mm' height='10mm'><line stroke='red' x2='" + c.size + "'/></svg>");
    INFO(c.size);
    CHECK_THAT(shape.sheet.paths.at(0).points_mm[1].x(), WithinAbs(c.mm, 1e-6));
  }
}

TEST_CASE("SvgReader.ViewBoxesKeepTheirAspectAsTheySay") {
  const std::string body = "<path stroke='red' d='M0 0L10 10'/></svg>";
  const auto first = [](const SvgDrawing& d) {
    return Vec2(d.sheet.paths.at(0).points_mm[0].x(), d.sheet.height_mm - d.sheet.paths.at(0).points_mm[0].y());
  };
  const std::string head = "<svg width='200mm' height='100mm' viewBox='0 0 10 10' ";
  CHECK_THAT((first(read(head + ">" + body)) - Vec2(50, 0)).norm(), WithinAbs(0, 1e-6));
  CHECK_THAT((first(read(head + "preserveAspectRatio='xMinYMin meet'>" + body)) - Vec2(0, 0)).norm(),
             WithinAbs(0, 1e-6));
  CHECK_THAT((first(read(head + "preserveAspectRatio='xMaxYMid'>" + body)) - Vec2(100, 0)).norm(), WithinAbs(0, 1e-6));
  CHECK_THAT((first(read(head + "preserveAspectRatio='xMidYMid slice'>" + body)) - Vec2(0, -50)).norm(),
             WithinAbs(0, 1e-6));
  const SvgDrawing stretched = read(head + "preserveAspectRatio='none'>" + body);
  CHECK_THAT(stretched.sheet.paths.at(0).points_mm[1].x(), WithinAbs(200, 1e-6));
  CHECK_THAT(stretched.sheet.paths.at(0).points_mm[1].y(), WithinAbs(0, 1e-6));
}

TEST_CASE("SvgReader.TransformsNest") {
  const SvgDrawing drawing =
      read_body("<g transform='translate(10,5) scale(2)'><g transform='rotate(90 1 1)'><path d='M1 1h3'/></g></g>");
  expect_points(drawing, {{12, 7}, {12, 13}});
  expect_points(read_body("<path transform='matrix(0 1 -1 0 20 0)' d='M1,2 3,4'/>"), {{18, 1}, {16, 3}});
  expect_points(read_body("<svg x='10' y='10' width='20' height='10' viewBox='0 0 2 1'><path d='M1 0v1'/></svg>"),
                {{20, 10}, {20, 20}});
  expect_points(read_body("<defs><path id='p' d='M0 0h5'/></defs><use href='#p' x='3' y='4' transform='scale(2)'/>"),
                {{6, 8}, {16, 8}});
  expect_points(
      read_body(
          "<symbol id='s' viewBox='0 0 10 10'><path d='M0 0h10'/></symbol><use href='#s' x='1' width='30' height='30'/>"),
      {{1, 0}, {31, 0}});
}

TEST_CASE("SvgReader.ShapesHaveTheirExactAreas") {
  const auto area = [](const std::string& body, double tolerance_mm) {
    SvgReadOptions options;
    options.flatness_mm = tolerance_mm;
    const SvgDrawing drawing = read_body(body, options);
    CHECK(drawing.sheet.paths.size() == 1u);
    {
      INFO(body);
      CHECK(drawing.sheet.paths.at(0).closed);
    }
    return std::abs(signed_area_mm2(drawing.sheet.paths.at(0).points_mm));
  };
  CHECK_THAT(area("<rect x='1' y='2' width='30' height='20'/>", 0.01), WithinAbs(600, 1e-6));
  CHECK_THAT(area("<polygon points='0,0 10,0-5,20'/>", 0.01), WithinAbs(100, 1e-6));
  const double pi = std::numbers::pi;
  struct Curved {
    std::string body;
    double area;
  };
  const Curved curved[] = {{"<circle cx='50' cy='30' r='20'/>", 400 * pi},
                           {"<ellipse cx='50' cy='30' rx='40' ry='10'/>", 400 * pi},
                           {"<rect width='40' height='30' rx='5'/>", 1200 - (4 - pi) * 25},
                           {"<path d='M10 30a20 20 0 1 1 40 0a20 20 0 0 1 -40 0z'/>", 400 * pi},
                           {"<path d='M0 0C0 20 30 20 30 0z'/>", 360},
                           {"<path d='M0 0Q15 30 30 0z'/>", 300}};
  for (const Curved& c : curved) {
    // Chords of a convex curve lose area in proportion to the tolerance.
    const double coarse = c.area - area(c.body, 0.04), fine = c.area - area(c.body, 0.01),
                 finest = c.area - area(c.body, 0.0025);
    INFO(c.body);
    CHECK(fine > 0);
    CHECK(fine < 0.01 * 130);  // two thirds of tolerance times length, at most
    CHECK_THAT(coarse / fine, WithinAbs(4, 1.3));
    CHECK_THAT(fine / finest, WithinAbs(4, 1.3));
  }
}

TEST_CASE("SvgReader.CurvesAreWithinTheTolerance") {
  const SvgDrawing drawing = read_body("<g transform='scale(1 0.5) rotate(30)'><circle r='30'/></g>");
  // Back through the map, the middle of every chord is on the circle within the tolerance, 0.01 mm, seen at most 2
  // times as large.
  const Eigen::Affine2d map = Eigen::Scaling(1.0, 0.5) * Eigen::Affine2d(Eigen::Rotation2Dd(std::numbers::pi / 6));
  const auto& points = drawing.sheet.paths.at(0).points_mm;
  double worst = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec2 a(points[i].x(), 60 - points[i].y()),
        b(points[(i + 1) % points.size()].x(), 60 - points[(i + 1) % points.size()].y());
    CHECK_THAT((map.inverse() * a).norm(), WithinAbs(30, 1e-5));
    worst = std::max(worst, 30 - (map.inverse() * Vec2((a + b) / 2)).norm());
  }
  CHECK(worst < 0.01);
  CHECK(worst > 0.002);  // not wasteful
}

TEST_CASE("SvgReader.LayersAreNamedOrColoured") {
  const SvgDrawing drawing = read(
      "<svg width='100mm' height='60mm' viewBox='0 0 100 60' xmlns:inkscape='i'><style>.a, .b {stroke:#0000FF;fill:none} line{stroke:rgb(0,0,0)}</style>"
      "<g inkscape:label='Cut 2'><path stroke='blue' d='M0 0h1'/></g><g id='score_lines'><g><path stroke='red' d='M0 1h1'/></g></g>"
      "<path class='x b' d='M0 2h1'/><line x2='1' y1='3' y2='3'/><path style='stroke:#f00' stroke='blue' d='M0 4h1'/>"
      "<path stroke='#00a000' d='M0 5h1'/><path stroke='#f0f' d='M0 6h1'/><path stroke='none' fill='none' d='M0 7h1'/>"
      "<g display='none'><path stroke='red' d='M0 8h1'/></g><path fill='#111' d='M0 9h1v1z'/></svg>");
  std::vector<CutLayer> layers;
  for (const CutPath& path : drawing.sheet.paths) layers.push_back(path.layer);
  CHECK(layers == std::vector<CutLayer>{CutLayer::cut, CutLayer::mark, CutLayer::mark, CutLayer::engrave, CutLayer::cut,
                                        CutLayer::note, CutLayer::note, CutLayer::engrave});
  REQUIRE(drawing.notes.size() == 1u);
  CHECK(drawing.notes[0].find("names no layer") != std::string::npos);
}

TEST_CASE("SvgReader.ReadsWhatWeWrite") {
  const CutSheet sheet{"t",
                       120,
                       80,
                       {{CutLayer::cut, {{10, 10}, {60.25, 10}, {60.25, 40}}, true, "piece-P1"},
                        {CutLayer::note, {{20, 15}, {20, 17.5}}, false, ""}}};
  const Bytes bytes = write_svg(sheet);
  const SvgDrawing drawing = read_svg_drawing(bytes, {}, Context());
  CHECK(drawing.sheet.width_mm == 120);
  CHECK(drawing.sheet.height_mm == 80);
  REQUIRE(drawing.sheet.paths.size() == 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    CHECK(drawing.sheet.paths[i].layer == sheet.paths[i].layer);
    CHECK(drawing.sheet.paths[i].closed == sheet.paths[i].closed);
    CHECK(drawing.sheet.paths[i].name == sheet.paths[i].name);
    REQUIRE(drawing.sheet.paths[i].points_mm.size() == sheet.paths[i].points_mm.size());
    for (std::size_t k = 0; k < sheet.paths[i].points_mm.size(); ++k)
      CHECK(drawing.sheet.paths[i].points_mm[k] == sheet.paths[i].points_mm[k]);
  }
}

TEST_CASE("SvgReader.RefusesWithTheFix") {
  CHECK(refusal("").find("empty") != std::string::npos);
  CHECK(refusal("hello").find("not XML") != std::string::npos);
  CHECK(refusal("<html/>").find("<html>") != std::string::npos);
  CHECK(refusal("\x1f\x8b rest").find("SVGZ") != std::string::npos);
  CHECK(refusal("<svg width='10mm' height='10mm'/>").find("The drawing is empty: it needs shapes") !=
        std::string::npos);
  CHECK(refusal("<svg width='10mm' height='10mm'><text>a</text></svg>").find("convert the text to paths") !=
        std::string::npos);
  CHECK(refusal("<svg width='10mm' height='10mm'><image/></svg>").find("pictures") != std::string::npos);
  const std::string red_line = "<path stroke='red' d='M0 0h10'/></svg>";
  CHECK(refusal("<svg viewBox='0 0 10 10'>" + red_line).find("user_unit") != std::string::npos);
  CHECK(refusal("<svg width='100%' height='100%' viewBox='0 0 10 10'>" + red_line).find("user_unit") !=
        std::string::npos);
  CHECK(refusal("<svg width='30000mm' height='10mm'>" + red_line).find("larger than 20 m") != std::string::npos);
  CHECK(refusal("<svg width='10mm' height='10mm'><g transform='scale(1e9)'>" + red_line.substr(0, red_line.size() - 6) +
                "</g></svg>")
            .find("farther than 20 m") != std::string::npos);
  CHECK(refusal("<svg width='10mm' height='10mm'><g id='a'><use href='#a'/></g></svg>").find("nested") !=
        std::string::npos);
  SvgReadOptions inches;
  inches.user_unit = UserUnit::inch;
  CHECK_THAT(read("<svg viewBox='0 0 10 10'>" + red_line, inches).sheet.width_mm, WithinAbs(254, 1e-9));
}

TEST_CASE("SvgReader.DamagedPartsAreReadAsFarAsTheyGo") {
  const SvgDrawing drawing = read_body("<path d='M0 0h10 L oops'/><path d='M0 1h10'/>");
  CHECK(drawing.sheet.paths.size() == 2u);
  REQUIRE(drawing.notes.size() == 1u);
  CHECK(drawing.notes[0].find("fault") != std::string::npos);
}

}  // namespace
}  // namespace formwright
