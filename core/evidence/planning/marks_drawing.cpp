// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/planning/marks_drawing.h"

#include <cstdio>

namespace formwright {
namespace {

constexpr double cross_mm = 3;  // from its middle
constexpr double text_mm = 4;

}  // namespace

std::string marks_svg(const MarksDrawing& d) {
  std::string text;
  const auto add = [&](const char* format, auto... values) {
    char line[400];
    std::snprintf(line, sizeof line, format, values...);
    text += line;
  };
  const Vec2 half = 0.5 * d.sheet_mm, opening = 0.5 * d.opening_mm;
  add("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.6gmm\" height=\"%.6gmm\" viewBox=\"%.6g %.6g %.6g %.6g\">\n",
      d.sheet_mm.x(), d.sheet_mm.y(), -half.x(), -half.y(), d.sheet_mm.x(), d.sheet_mm.y());
  text +=
      "<title>Marks to measure, true size, seen from above</title>\n<g fill=\"none\" stroke=\"#000\" stroke-width=\"0.2\">\n";
  add("<rect x=\"%.6g\" y=\"%.6g\" width=\"%.6g\" height=\"%.6g\"/>\n", -half.x(), -half.y(), d.sheet_mm.x(),
      d.sheet_mm.y());
  add("<rect stroke-dasharray=\"4 2\" x=\"%.6g\" y=\"%.6g\" width=\"%.6g\" height=\"%.6g\"/>\n", -opening.x(),
      -opening.y(), d.opening_mm.x(), d.opening_mm.y());
  add("<path stroke=\"#999\" stroke-dasharray=\"1 3\" d=\"M%.6g 0H%.6gM0 %.6gV%.6g\"/>\n", -half.x(), half.x(),
      -half.y(), half.y());
  for (const Vec2& at : d.marks_mm)  // y of a drawing points down
    add("<path d=\"M%.6g %.6gh%.6gM%.6g %.6gv%.6g\"/>\n", at.x() - cross_mm, -at.y(), 2 * cross_mm, at.x(),
        -at.y() - cross_mm, 2 * cross_mm);
  add("</g>\n<g font-family=\"sans-serif\" font-size=\"%.6g\" fill=\"#000\">\n", text_mm);
  int number = d.first_number;
  for (const Vec2& at : d.marks_mm)
    add("<text x=\"%.6g\" y=\"%.6g\">%d</text>\n", at.x() + 0.8, -at.y() - 0.8, number++);
  add("<text x=\"%.6g\" y=\"%.6g\">front</text>\n</g>\n</svg>\n", -5.0, half.y() - 1.5);
  return text;
}

}  // namespace formwright
