// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <set>

#include "base/data/xml_text.h"
#include "fabrication/sheet/cut_sheet.h"
#include "formats/shared/text_out.h"

namespace formwright {
namespace {

double rounded(double mm) { return std::round(1e4 * mm) / 1e4; }

}  // namespace

CutSheet side_by_side(const std::vector<CutSheet>& sheets, double gap_mm) {
  CutSheet all;
  std::set<std::string> names;
  for (std::size_t i = 0; i < sheets.size(); ++i) {
    const CutSheet& sheet = sheets[i];
    if (i > 0) all.width_mm += gap_mm;
    else all.title = sheet.title, all.kerf_mm = sheet.kerf_mm;
    const Vec2 corner(all.width_mm, 0);
    const std::string number = std::to_string(i + 1);
    all.paths.push_back({CutLayer::note,
                         {corner, corner + Vec2(sheet.width_mm, 0), corner + Vec2(sheet.width_mm, sheet.height_mm),
                          corner + Vec2(0, sheet.height_mm)},
                         true,
                         "sheet-" + number});
    for (CutPath path : sheet.paths) {
      for (Vec2& point : path.points_mm) point += corner;
      if (!path.name.empty() && !names.insert(path.name).second) path.name += "-sheet-" + number;
      all.paths.push_back(std::move(path));
    }
    all.width_mm += sheet.width_mm;
    all.height_mm = std::max(all.height_mm, sheet.height_mm);
  }
  return all;
}

Bytes write_svg(const CutSheet& sheet) {
  TextOut out;
  const double width = rounded(sheet.width_mm), height = rounded(sheet.height_mm);
  out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" width=\""
      << width << "mm\" height=\"" << height << "mm\" viewBox=\"0 0 " << width << ' ' << height << '"';
  if (sheet.kerf_mm > 0) out << ' ' << kerf_attribute << "=\"" << rounded(sheet.kerf_mm) << '"';
  out << ">\n<title>" << xml_text(sheet.title) << "</title>\n";
  for (int layer = 0; layer < cut_layer_count; ++layer) {
    const CutLayerStyle& style = cut_layer_styles[layer];
    out << "<g id=\"" << style.name << "\" fill=\"none\" stroke=\"" << style.colour << "\" stroke-width=\"0.1\">\n";
    for (const CutPath& path : sheet.paths) {
      if (path.layer != static_cast<CutLayer>(layer) || path.points_mm.size() < 2) continue;
      out << "<path";
      if (!path.name.empty()) out << " id=\"" << path.name << '"';
      out << " d=\"";
      for (std::size_t k = 0; k < path.points_mm.size(); ++k)
        out << (k == 0 ? 'M' : 'L') << rounded(path.points_mm[k].x()) << ' '
            << rounded(sheet.height_mm - path.points_mm[k].y());
      out << (path.closed ? "Z\"/>\n" : "\"/>\n");
    }
    out << "</g>\n";
  }
  out << "</svg>\n";
  return to_bytes(out.text());
}

}  // namespace formwright
