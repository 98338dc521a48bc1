// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/sheet/cut_sheet.h"

#include <catch2/catch_test_macros.hpp>

#include <algorithm>
#include <sstream>

namespace formwright {
namespace {

CutSheet example() {
  return {"A & B",
          120,
          80,
          {{CutLayer::cut, {{10, 10}, {60.25, 10}, {60.25, 40}}, true, "piece-P1"},
           {CutLayer::mark, {{20, 15}, {20, 17.5}}, false, ""}}};
}

TEST_CASE("CutSheet.SvgIsTrueToSizeWithYDown") {
  const Bytes bytes = write_svg(example());
  const std::string svg(as_text(bytes));
  CHECK(svg.find("width=\"120mm\" height=\"80mm\" viewBox=\"0 0 120 80\"") != std::string::npos);
  CHECK(svg.find("<path id=\"piece-P1\" d=\"M10 70L60.25 70L60.25 40Z\"/>") != std::string::npos);
  CHECK(svg.find("<path d=\"M20 65L20 62.5\"/>") != std::string::npos);
  CHECK(svg.find("A &amp; B") != std::string::npos);
  for (const CutLayerStyle& style : cut_layer_styles)
    CHECK(svg.find("<g id=\"" + std::string(style.name) + "\" fill=\"none\" stroke=\"" + style.colour) !=
          std::string::npos);
}

TEST_CASE("CutSheet.DxfIsPairsInMillimetresOnItsLayers") {
  const Bytes bytes = write_dxf(example());
  std::istringstream lines{std::string(as_text(bytes))};
  std::string code, value, units, entity;
  std::vector<std::string> entities, layers;
  std::vector<double> x;
  for (std::string before; std::getline(lines, code) && std::getline(lines, value); before = value) {
    if (before == "$INSUNITS") units = value;
    if (code == "0") entity = value, entities.push_back(value);
    if (code == "10" && entity == "VERTEX") x.push_back(std::stod(value));
    if (code == "8" && entity == "LINE") layers.push_back(value);
  }
  CHECK(units == "4");
  CHECK(entities.back() == "EOF");
  CHECK(std::count(entities.begin(), entities.end(), "POLYLINE") == 1);
  CHECK(x == std::vector<double>{10, 60.25, 60.25});
  CHECK(layers == std::vector<std::string>{"mark"});
}

TEST_CASE("CutSheet.SheetsStandSideBySideAndNamesOnce") {
  const CutSheet all = side_by_side({example(), example()}, 20);
  CHECK(all.width_mm == 260);
  CHECK(all.height_mm == 80);
  const auto find = [&](const std::string& name) {
    return std::count_if(all.paths.begin(), all.paths.end(), [&](const CutPath& path) { return path.name == name; });
  };
  CHECK(find("piece-P1") == 1);
  CHECK(find("piece-P1-sheet-2") == 1);
  CHECK(find("sheet-2") == 1);
}

}  // namespace
}  // namespace formwright
