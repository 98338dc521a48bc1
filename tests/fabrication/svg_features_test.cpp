// SPDX-License-Identifier: GPL-3.0-or-later
// What of SVG is followed, and what is said of the rest. Where lines lie is tested against browsers, too
// (tests/reliability/drawing_raster_test.py).
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>
#include <string>

#include "base/error.h"
#include "fabrication/svg/style/svg_colour.h"
#include "fabrication/svg/grammar/svg_grammar.h"
#include "fabrication/svg/svg_reader.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

SvgDrawing read_with_look(const std::string& body, const std::string& look = "fill='none' stroke='red'") {
  return read_svg_drawing(
      as_bytes("<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='60mm' viewBox='0 0 100 60' " + look +
               ">" + body + "</svg>"),
      {}, Context());
}

std::string feature_refusal(const std::string& svg) {
  try {
    read_svg_drawing(as_bytes(svg), {}, Context());
  } catch (const Error& error) {
    CHECK(error.where() == "drawing");
    return error.what();
  }
  FAIL_CHECK("was not refused: " << svg.substr(0, 200));
  return "";
}

/// "x0,y0 x1,y1; ..." of all paths, y from the top, rounded to hundredths.
std::string lines(const SvgDrawing& drawing) {
  std::string result;
  for (const CutPath& path : drawing.sheet.paths) {
    if (!result.empty()) result += "; ";
    for (std::size_t i = 0; i < path.points_mm.size(); ++i) {
      const auto rounded = [](double mm) {
        std::string text = std::to_string(std::round(100 * mm) / 100 + 0.0);
        text.erase(text.find_last_not_of('0') + 1);
        if (text.ends_with('.')) text.pop_back();
        return text == "-0" ? "0" : text;
      };
      result += (i == 0 ? "" : " ") + rounded(path.points_mm[i].x()) + "," +
                rounded(drawing.sheet.height_mm - path.points_mm[i].y());
    }
    if (path.closed) result += " z";
  }
  return result;
}

/// All notes, one a line.
std::string notes(const std::string& body) {
  std::string result;
  for (const std::string& note : read_with_look(body).notes) result += note + "\n";
  return result;
}

const std::string line = "<path d='M0 1h9'/>";

TEST_CASE("SvgFeatures.TransformsOfCssAreThoseOfBrowsers") {
  CHECK(lines(read_with_look("<path style='transform:translate(10px,5px)' d='M0 0h1'/>")) == "10,5 11,5");
  CHECK(lines(read_with_look("<path style='transform:rotate(90deg);transform-origin:10px 10px' d='M10 0h5'/>")) ==
        "20,10 20,15");
  CHECK(lines(read_with_look(
            "<path style='transform:scale(2);transform-box:fill-box;transform-origin:center' d='M10 10h4v2'/>")) ==
        "8,9 16,9 16,13");
  CHECK(lines(read_with_look("<path style='rotate:0.25turn;translate:5px' d='M0 0h5'/>")) == "5,0 5,5");
  CHECK(lines(read_with_look(
            "<style>path{transform:translate(50%,50%)}</style><path transform='scale(9)' d='M0 0h1'/>")) ==
        "50,30 51,30");
  CHECK(lines(read_with_look("<path transform='translate(5-1)scale(2-1)' d='M0 0h1'/>")) == "5,-1 7,-1");
  CHECK(lines(read_with_look("<path style='transform:rotate(30)' transform='translate(1)' d='M0 0h1'/>")) == "1,0 2,0");
  CHECK(notes("<path style='transform:rotateX(30deg)' d='M0 0h1'/>").find("fault") != std::string::npos);
}

TEST_CASE("SvgFeatures.DashesAreCut") {
  CHECK(lines(read_with_look("<path stroke-dasharray='3 2' d='M0 0h10v1'/>")) == "0,0 3,0; 5,0 8,0; 10,0 10,1");
  CHECK(lines(read_with_look("<path stroke-dasharray='4' stroke-dashoffset='5' d='M0 0h10'/>")) == "3,0 7,0");
  CHECK(lines(read_with_look("<path stroke-dasharray='2 1 1' d='M0 0h10'/>")) == "0,0 2,0; 3,0 4,0; 6,0 7,0; 8,0 10,0");
  CHECK(lines(read_with_look("<g transform='scale(2)' stroke-dasharray='1'><path d='M0 0h4'/></g>")) ==
        "0,0 2,0; 4,0 6,0");
  CHECK(lines(read_with_look("<path pathLength='4' stroke-dasharray='1' d='M0 0h40'/>")) == "0,0 10,0; 20,0 30,0");
  CHECK(lines(read_with_look("<rect stroke-dasharray='5 3' width='6' height='2'/>")) == "0,0 5,0; 6,2 1,2");
  CHECK(lines(read_with_look("<path stroke-dasharray='3 -1' d='M0 0h10'/><path stroke-dasharray='0' d='M0 1h10'/>")) ==
        "0,0 10,0; 0,1 10,1");
  CHECK(notes(line + "<path stroke-dasharray='0 2' d='M0 0h10'/>").find("dashes of length zero") != std::string::npos);
}

TEST_CASE("SvgFeatures.ClipsCutLinesWhereTheyEnd") {
  CHECK(lines(read_with_look("<svg x='10' y='10' width='20' height='10'><path d='M-5 5h50'/></svg>")) == "10,15 30,15");
  CHECK(lines(read_with_look(
            "<svg x='10' y='10' width='20' height='10' overflow='visible'><path d='M-5 5h50'/></svg>")) ==
        "5,15 55,15");
  const std::string clip = "<clipPath id='c'><rect x='5' y='5' width='10' height='10'/></clipPath>";
  CHECK(lines(read_with_look(clip + "<path clip-path='url(#c)' d='M0 10h40'/>")) == "5,10 15,10");
  // A line that runs in and out keeps its order; a closed one is not broken where it begins.
  CHECK(lines(read_with_look(clip + "<path clip-path='url(#c)' d='M0 6h20v2h-20z'/>")) == "5,6 15,6; 15,8 5,8");
  CHECK(lines(read_with_look(clip + "<path clip-path='url(#c)' d='M10 6h20v2h-20z'/>")) == "15,8 10,8 10,6 15,6");
  CHECK(lines(read_with_look(clip + "<path clip-path='url(#c)' d='M6 6h2v2z'/>")) == "6,6 8,6 8,8 z");
  // On the edge is inside.
  CHECK(lines(read_with_look(clip + "<path clip-path='url(#c)' d='M0 5h40'/>")) == "5,5 15,5");
  const std::string filled =
      lines(read_with_look(clip + "<rect clip-path='url(#c)' width='10' height='10' fill='red' stroke='none'/>"));
  for (const char* corner : {"5,5", "10,5", "10,10", "5,10"}) {
    INFO(filled);
    CHECK(filled.find(corner) != std::string::npos);
  }
  CHECK(lines(read_with_look(line + "<clipPath id='e'/><path clip-path='url(#e)' d='M0 10h40'/>")) == "0,1 9,1");
  CHECK(notes(line + "<path clip-path='circle(3px)' d='M0 10h40'/>").find("clip was not applied") != std::string::npos);
}

TEST_CASE("SvgFeatures.StylesCascade") {
  const auto layer = [](const std::string& style, const std::string& element) {
    return read_with_look("<style>" + style + "</style>" + element).sheet.paths.at(0).layer;
  };
  const std::string path = "<g class='k'><path class='a b' id='i' data-n='12' d='M0 0h1'/></g>";
  for (const char* selector : {"path", ".a", "#i", "path.a.b", "g path", "g > path", ".k .b", "[data-n]",
                               "[data-n='12']", "[data-n^='1']", "path:first-child", ":not(.z)", "svg *", "x, path"}) {
    INFO(selector);
    CHECK(layer(std::string(selector) + "{stroke:blue}", path) == CutLayer::mark);
  }
  for (const char* selector : {"rect", ".c", "#a", "path.z", "path > g", "[data-n='1']", "path:nth-child(2)",
                               "path:not(.a)", "g + path", "path:hover"}) {
    INFO(selector);
    CHECK(layer(std::string(selector) + "{stroke:blue}", path) == CutLayer::cut);
  }
  CHECK(layer("#i{stroke:blue} .a.b{stroke:black}", path) == CutLayer::mark);
  CHECK(layer(".a{stroke:blue!important} #i{stroke:black}", path) == CutLayer::mark);
  CHECK(layer("@media print{path{stroke:black}} @media screen{path{stroke:blue}}", path) == CutLayer::mark);
  CHECK(layer("/* path{stroke:black} */ path{/**/stroke:blue}", path) == CutLayer::mark);
  CHECK(notes("<style>path::before{stroke:blue} @import 'x.css';</style>" + line)
            .find("2 style rules were not followed") != std::string::npos);
}

TEST_CASE("SvgFeatures.ColoursOfEveryForm") {
  struct Case {
    const char* text;
    std::array<int, 3> rgb;
    double alpha;
  };
  for (const Case& c : {Case{"#f80", {255, 136, 0}, 1}, Case{"#ff880080", {255, 136, 0}, 128 / 255.0},
                        Case{"rgb(100%, 0%, 50%)", {255, 0, 128}, 1}, Case{"rgb(1 2 3 / 0.5)", {1, 2, 3}, 0.5},
                        Case{"hsl(120, 100%, 25%)", {0, 128, 0}, 1}, Case{"hsla(240,100%,50%,0)", {0, 0, 255}, 0},
                        Case{"HSL(-120deg 100% 50%)", {0, 0, 255}, 1}, Case{"hwb(0 0% 0%)", {255, 0, 0}, 1},
                        Case{"RebeccaPurple", {102, 51, 153}, 1}, Case{"transparent", {0, 0, 0}, 0}}) {
    const auto colour = read_colour(c.text);
    INFO(c.text);
    REQUIRE(colour);
    CHECK(colour->rgb == c.rgb);
    CHECK_THAT(colour->alpha, WithinAbs(c.alpha, 1e-9));
  }
  for (const char* text : {"", "none", "#12", "#ggg", "rgb(1,2)", "rgb(1,2,3", "hsl(a,b,c)", "url(#a)", "lab(1 2 3)"}) {
    INFO(text);
    CHECK_FALSE(read_colour(text));
  }
  CHECK(read_with_look("<path stroke='hsl(240,100%,50%)' d='M0 0h1'/>").sheet.paths.at(0).layer == CutLayer::mark);
  CHECK(read_with_look("<g color='blue'><path stroke='currentColor' d='M0 0h1'/></g>").sheet.paths.at(0).layer ==
        CutLayer::mark);
}

TEST_CASE("SvgFeatures.WhatIsNotPaintedIsNotCut") {
  for (const char* hidden :
       {"opacity='0'", "style='opacity:0'", "stroke-opacity='0'", "stroke='rgba(255,0,0,0)'", "visibility='hidden'",
        "display='none'", "stroke='none'", "stroke='url(#gone)'", "systemLanguage='de'", "requiredExtensions='x'"}) {
    INFO(hidden);
    CHECK(lines(read_with_look(line + "<path d='M0 5h9' " + hidden + "/>")) == "0,1 9,1");
  }
  CHECK(lines(read_with_look(
            "<switch><path systemLanguage='fr' d='M0 5h9'/><path d='M0 1h9'/><path d='M0 2h9'/></switch>")) ==
        "0,1 9,1");
  // What is filled is closed; a line that is filled is nothing.
  CHECK(lines(read_with_look(
            "<path fill='red' stroke='none' d='M0 0h9v9'/><path fill='red' stroke='none' d='M0 0h9'/>")) ==
        "0,0 9,0 9,9 z");
}

TEST_CASE("SvgFeatures.WhatIsLeftOutIsSaid") {
  struct Case {
    const char *body, *sentence;
  };
  for (
      const Case& c :
      {Case{"<text>a</text>", "convert it to paths"}, Case{"<image/>", "picture was left out"},
       Case{"<foreignObject/>", "foreignObject"}, Case{"<mask id='m'/><g mask='url(#m)'/>", "mask was not applied"},
       Case{"<g filter='url(#f)'/>", "filter was not applied"},
       Case{"<marker id='m'/><path marker-end='url(#m)' d='M0 0h1'/>", "arrowheads"},
       Case{"<path stroke-width='0' d='M0 0h1'/>", "no width"},
       Case{"<path stroke='none' fill='red' d='M0 0h1'/>", "neither a stroke nor an area"},
       Case{"<path stroke='lab(1 2 3)' d='M0 0h1'/>", "not understood"},
       Case{
           "<linearGradient id='g'><stop stop-color='red'/><stop stop-color='blue'/></linearGradient><path stroke='url(#g)' d='M0 0h1'/>",
           "gradient"},
       Case{"<animate/>", "animation was not followed"}, Case{"<script/>", "script was not run"},
       Case{"<path style='&st0;' d='M0 0h1'/>", "entity of XML"}, Case{"<use href='other.svg#a'/>", "another file"},
       Case{"<path systemLanguage='de' d='M0 0h1'/>", "language"},
       Case{"<path d='M-5 0h1'/>", "outside the drawing's page"},
       Case{"<path stroke='#f0f' d='M0 0h1'/>", "names no layer"}}) {
    const std::string all = notes(line + c.body);
    {
      INFO(c.body << ": " << all);
      CHECK(all.find(c.sentence) != std::string::npos);
    }
    INFO("one note only: " << all);
    CHECK(all.find('\n') == all.size() - 1);
  }
  CHECK(notes(line) == "");
  // A swatch of Inkscape: a gradient of one colour.
  CHECK(
      read_with_look(
          "<linearGradient id='g'><stop style='stop-color:#00f'/></linearGradient><path stroke='url(#g)' d='M0 0h1'/>")
          .sheet.paths.at(0)
          .layer == CutLayer::mark);
}

TEST_CASE("SvgFeatures.TextOfEveryKind") {
  const std::string plain =
      "<svg width='100mm' height='60mm' viewBox='0 0 100 60'>\n<path\nstroke='red'\nd='M0 1\nh9'/></svg>";
  std::string returns = plain;
  for (char& c : returns)
    if (c == '\n') c = '\r';
  std::string wide = "\xff\xfe";
  for (const char c : plain) wide += {c, '\0'};
  for (const std::string& file :
       {plain, returns, "\xef\xbb\xbf" + plain, "\xef\xbb\xbf<?xml version='1.0' encoding='UTF-8'?>" + plain, wide})
    CHECK(lines(read_svg_drawing(as_bytes(file), {}, Context())) == "0,1 9,1");
  CHECK(feature_refusal("<svg width='100' height='60'>" + line + "</svg>").find("no unit") != std::string::npos);
  CHECK(feature_refusal("<svg width='100%' height='100%'>" + line + "</svg>").find("are percentages") !=
        std::string::npos);
  CHECK(feature_refusal("<svg width='9mm' height='9mm'><use href='a.svg#b'/></svg>").find("another file") !=
        std::string::npos);
  SvgReadOptions pixels;
  pixels.user_unit = UserUnit::px;
  CHECK_THAT(
      read_svg_drawing(as_bytes("<svg width='96' height='96'><path stroke='red' d='M0 0h1'/></svg>"), pixels, Context())
          .sheet.width_mm,
      WithinAbs(25.4, 1e-9));
}

TEST_CASE("SvgFeatures.HugeDrawingsAreRefusedWithTheFix") {
  const auto of = [](const std::string& body) {
    return "<svg width='100mm' height='60mm' viewBox='0 0 100 60' stroke='red' fill='none'>" + body + "</svg>";
  };
  CHECK(feature_refusal(of("<path d='M0 0C1e9 1e9 -1e9 1e9 1 1'/>")).find("check its units") != std::string::npos);
  CHECK(feature_refusal(of("<path d='M0 0h1e400'/>")).find('.') != std::string::npos);
  CHECK(feature_refusal(of("<path stroke-dasharray='1e-7' d='M0 0h90'/>")).find("make its dashes longer") !=
        std::string::npos);
  std::string open, close;
  for (int i = 0; i < 250; ++i) {
    open += "<g clip-path='url(#c)'>";
    close += "</g>";
  }
  CHECK(lines(read_with_look("<clipPath id='c'><rect width='5' height='5'/></clipPath>" + open + line + close)) ==
        "0,1 5,1");
  CHECK(feature_refusal(of(open + "<g><g><g><g><g><g><g>" + line)).find("not XML") != std::string::npos);
  CHECK(feature_refusal(of(open + open + line + close + close)).find("256 levels") != std::string::npos);
  std::string copies = "<path id='a0' d='M0 0h1'/>";
  for (int i = 1; i < 30; ++i) {
    const std::string use = "<use href='#a" + std::to_string(i - 1) + "'/>";
    copies += "<g id='a" + std::to_string(i) + "'>" + use + use + use + "</g>";
  }
  CHECK(feature_refusal(of(copies)).find("<use>") != std::string::npos);
  std::string rules, groups;
  for (int i = 0; i < 6'000; ++i) {
    rules += "g{r:1}";
    groups += "<g/>";
  }
  CHECK(feature_refusal(of("<style>" + rules + "</style>" + groups + line)).find("style rules") != std::string::npos);
}

}  // namespace
}  // namespace formwright
