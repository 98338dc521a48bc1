// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/toolpath/toolpath_preview.h"

#include <cmath>
#include <utility>

#include "formats/shared/text_out.h"

namespace formwright {

Bytes write_toolpath_svg(const Toolpath& path, const MachineOptions& machine) {
  const auto rounded = [](double v) { return std::round(1e3 * v) / 1e3; };
  const double width = rounded(machine.bed_x_mm), height = rounded(machine.bed_y_mm);
  TextOut out;
  out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" width=\""
      << width << "mm\" height=\"" << height << "mm\" viewBox=\"0 0 " << width << ' ' << height
      << "\">\n<g id=\"bed\" fill=\"#ffffff\" stroke=\"#808080\" stroke-width=\"0.5\"><rect width=\"" << width
      << "\" height=\"" << height << "\"/></g>\n<g id=\"no-go\" fill=\"#ffd0d0\" stroke=\"none\">\n";
  for (const BedRectangle& zone : read_no_go(machine.no_go))
    out << "<rect x=\"" << rounded(zone.x0_mm) << "\" y=\"" << rounded(machine.bed_y_mm - zone.y1_mm) << "\" width=\""
        << rounded(zone.x1_mm - zone.x0_mm) << "\" height=\"" << rounded(zone.y1_mm - zone.y0_mm) << "\"/>\n";
  out << "</g>\n";
  constexpr std::pair<std::string_view, std::string_view> groups[] = {{"travel", "#b0b0b0"}, {"engrave", "#000000"},
                                                                      {"mark", "#0000ff"},   {"cut", "#ff0000"},
                                                                      {"rough", "#c08000"},  {"finish", "#008080"}};
  for (const auto& [name, colour] : groups) {
    out << "<g id=\"" << name << "\" fill=\"none\" stroke=\"" << colour << "\" stroke-width=\"0.1\">\n";
    for (const ToolMove& move : path.moves) {
      if ((move.work ? std::string_view(move.layer) : std::string_view("travel")) != name) continue;
      out << "<path d=\"";
      for (std::size_t i = 0; i < move.points_mm.size(); ++i)
        out << (i == 0 ? 'M' : 'L') << rounded(move.points_mm[i].x()) << ' '
            << rounded(machine.bed_y_mm - move.points_mm[i].y());
      out << "\"/>\n";
    }
    out << "</g>\n";
  }
  out << "</svg>\n";
  return to_bytes(out.text());
}

}  // namespace formwright
