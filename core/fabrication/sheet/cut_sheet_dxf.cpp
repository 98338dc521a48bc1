// SPDX-License-Identifier: GPL-3.0-or-later
// Our own writer: dxflib, the one packaged library, writes into files only, and R12 needs no more than this.
#include <cmath>

#include "fabrication/sheet/cut_sheet.h"
#include "formats/shared/text_out.h"

namespace formwright {
namespace {

class DxfText {
 public:
  void pair(int code, std::string_view value) { out_ << code << '\n' << value << '\n'; }
  void pair(int code, int value) { out_ << code << '\n' << value << '\n'; }
  void pair(int code, double mm) {
    out_ << code << '\n';
    const double value = std::round(1e6 * mm) / 1e6;
    out_ << value;
    // Readers tell reals from integers by the point.
    if (value == std::floor(value)) out_ << ".0";
    out_ << '\n';
  }
  void point(const Vec2& p, int offset = 0) {
    pair(10 + offset, p.x());
    pair(20 + offset, p.y());
    pair(30 + offset, 0.0);
  }
  Bytes bytes() { return to_bytes(out_.text()); }

 private:
  TextOut out_;
};

}  // namespace

Bytes write_dxf(const CutSheet& sheet) {
  DxfText dxf;
  const auto begin = [&](const char* section) { dxf.pair(0, "SECTION"), dxf.pair(2, section); };
  begin("HEADER");
  dxf.pair(9, "$ACADVER"), dxf.pair(1, "AC1009");
  dxf.pair(9, "$INSUNITS"), dxf.pair(70, 4);
  dxf.pair(9, "$EXTMIN"), dxf.point(Vec2::Zero());
  dxf.pair(9, "$EXTMAX"), dxf.point(Vec2(sheet.width_mm, sheet.height_mm));
  dxf.pair(0, "ENDSEC");
  begin("TABLES");
  dxf.pair(0, "TABLE"), dxf.pair(2, "LTYPE"), dxf.pair(70, 1);
  dxf.pair(0, "LTYPE"), dxf.pair(2, "CONTINUOUS"), dxf.pair(70, 0), dxf.pair(3, "Solid line"), dxf.pair(72, 65),
      dxf.pair(73, 0), dxf.pair(40, 0.0);
  dxf.pair(0, "ENDTAB");
  dxf.pair(0, "TABLE"), dxf.pair(2, "LAYER"), dxf.pair(70, cut_layer_count);
  for (const CutLayerStyle& style : cut_layer_styles)
    dxf.pair(0, "LAYER"), dxf.pair(2, style.name), dxf.pair(70, 0), dxf.pair(62, style.colour_index),
        dxf.pair(6, "CONTINUOUS");
  dxf.pair(0, "ENDTAB");
  dxf.pair(0, "ENDSEC");
  begin("ENTITIES");
  for (const CutPath& path : sheet.paths) {
    const char* layer = cut_layer_styles[static_cast<int>(path.layer)].name;
    if (path.points_mm.size() < 2) continue;
    if (path.points_mm.size() == 2) {
      dxf.pair(0, "LINE"), dxf.pair(8, layer), dxf.point(path.points_mm[0]), dxf.point(path.points_mm[1], 1);
      continue;
    }
    dxf.pair(0, "POLYLINE"), dxf.pair(8, layer), dxf.pair(66, 1), dxf.point(Vec2::Zero()),
        dxf.pair(70, path.closed ? 1 : 0);
    for (const Vec2& point : path.points_mm) dxf.pair(0, "VERTEX"), dxf.pair(8, layer), dxf.point(point);
    dxf.pair(0, "SEQEND"), dxf.pair(8, layer);
  }
  dxf.pair(0, "ENDSEC");
  dxf.pair(0, "EOF");
  return dxf.bytes();
}

}  // namespace formwright
