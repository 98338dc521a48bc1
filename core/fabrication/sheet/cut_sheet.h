// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Drawings for a cutter or plotter at exact size: polylines in mm on layers that say what the machine does with them.
#include <string>
#include <vector>

#include "base/bytes.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

enum class CutLayer { cut, mark, engrave, note };
inline constexpr int cut_layer_count = 4;

/// The layer's name in every format and its colour: "#rrggbb" in SVG, AutoCAD's colour index in DXF.
struct CutLayerStyle {
  const char* name;
  const char* colour;
  int colour_index;
};
inline constexpr CutLayerStyle cut_layer_styles[cut_layer_count] = {
    {"cut", "#ff0000", 1}, {"mark", "#0000ff", 5}, {"engrave", "#000000", 7}, {"note", "#00a000", 3}};

struct CutPath {
  CutLayer layer = CutLayer::cut;
  std::vector<Vec2> points_mm;  // at least two; y up
  bool closed = false;          // the last point is joined to the first, which is not repeated
  std::string name = "";        // letters, digits and -; unique in its sheet, or empty
};

/// A sheet of material, its lower left corner at the origin.
struct CutSheet {
  std::string title;
  double width_mm = 0, height_mm = 0;
  std::vector<CutPath> paths;
  double kerf_mm = 0;  // for which closed cuts are moved already: outlines by half of it outwards, openings inwards
};

inline constexpr const char* kerf_attribute = "data-formwright-kerf-mm";

/// Sheets side by side, `gap_mm` apart, as one drawing; each sheet's edge is drawn as a note "sheet-1", "sheet-2", ...;
/// names get the sheet's number behind them only where they would stand twice. The sheets have one kerf.
CutSheet side_by_side(const std::vector<CutSheet>& sheets, double gap_mm);

/// SVG 1.1 of exactly the sheet's size, 1 user unit = 1 mm, y down; a group a layer. Coordinates have four decimals. A
/// kerf that the cuts are moved for stands in the root's kerf_attribute, in mm, so that nobody moves them again.
Bytes write_svg(const CutSheet& sheet);

/// ASCII DXF R12 in mm ($INSUNITS 4), y up: LINE for two points, POLYLINE for more, the layers in the layer table.
/// Coordinates have six decimals.
Bytes write_dxf(const CutSheet& sheet);

}  // namespace formwright
