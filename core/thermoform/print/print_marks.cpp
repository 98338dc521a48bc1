// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/print/print_marks.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace formwright {
namespace {

constexpr double mark_line_mm = 0.25, outline_mm = 0.15;

/// Half of sheet and opening, and what of the rim is left for marks.
struct Rim {
  Vec2 sheet, opening, middle;
  double width;

  explicit Rim(const ThermoformPrintOptions& options)
      : sheet(options.sheet_x_mm / 2, options.sheet_y_mm / 2),
        opening(options.clamp_opening_x_mm / 2, options.clamp_opening_y_mm / 2),
        middle((sheet + opening) / 2),
        width((sheet - opening).minCoeff()) {}
  double arm_mm() const { return std::min(3.0, 0.35 * width); }
  double letters_mm() const { return std::min(4.0, 0.4 * width); }
};

std::string text(const char* format, double a, double b) {
  char buffer[96];
  std::snprintf(buffer, sizeof buffer, format, a, b);
  return buffer;
}

void add_marks(Drawing& drawing, const ThermoformPrintOptions& options) {
  const Rim rim(options);
  for (const RegistrationMark& mark : registration_marks(options)) {
    drawing.cross(mark.place_mm, rim.arm_mm(), mark_line_mm);
    // The number stands beside the cross, along the rim, towards the middle of the side.
    const double away = rim.arm_mm() + rim.letters_mm();
    const bool on_side = std::abs(mark.place_mm.y()) < 1e-9;
    const Vec2 step = on_side ? Vec2(0, away) : Vec2(mark.place_mm.x() > 1e-9 ? -away : away, 0);
    drawing.label(mark.place_mm + step, rim.letters_mm(), mark.name);
  }
  if (rim.width >= narrowest_rim_mm)
    drawing.label(Vec2(-rim.middle.x() / 2, -rim.middle.y()), rim.letters_mm(), "FRONT");
}

}  // namespace

std::vector<RegistrationMark> registration_marks(const ThermoformPrintOptions& options) {
  const Rim rim(options);
  if (rim.width < narrowest_rim_mm) return {};
  constexpr double sign[8][2] = {{-1, -1}, {0, -1}, {1, -1}, {1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}};
  std::vector<RegistrationMark> marks;
  for (const auto& s : sign)
    marks.push_back({std::to_string(marks.size() + 1), Vec2(s[0] * rim.middle.x(), s[1] * rim.middle.y())});
  return marks;
}

Drawing sheet_drawing(const ThermoformPrintOptions& options) {
  const Rim rim(options);
  Drawing drawing;
  if (options.outlines) {
    // Within the sheet, so that the line is not cut in half.
    const Vec2 inside = Vec2::Constant(outline_mm / 2);
    drawing.rectangle(-rim.sheet + inside, rim.sheet - inside, outline_mm);
    if (rim.width > 0) drawing.rectangle(-rim.opening, rim.opening, outline_mm);
  }
  if (options.marks) add_marks(drawing, options);
  return drawing;
}

std::optional<Label> mirrored_label(const ThermoformPrintOptions& options) {
  const Rim rim(options);
  if (!options.mirror || rim.width < narrowest_rim_mm) return std::nullopt;
  return Label{Vec2(-rim.middle.x() / 2, rim.middle.y()), rim.letters_mm(), "MIRRORED"};
}

Drawing frame_template(const ThermoformPrintOptions& options) {
  const Rim rim(options);
  Drawing drawing;
  drawing.rectangle(-rim.sheet, rim.sheet, outline_mm, true);
  drawing.rectangle(-rim.opening, rim.opening, 2 * outline_mm);
  add_marks(drawing, options);
  const double size = std::clamp(0.02 * rim.opening.minCoeff() * 2, 1.0, 4.0);
  double y = 0.7 * rim.opening.y();
  const auto say = [&](const std::string& line) {
    drawing.label(Vec2(0, y), size, line);
    y -= 2 * size;
  };
  say("CLAMP FRAME SEEN FROM ABOVE, TRUE SIZE");
  say(text("OPENING %.1f x %.1f MM", options.clamp_opening_x_mm, options.clamp_opening_y_mm));
  say(text("SHEET %.1f x %.1f MM", options.sheet_x_mm, options.sheet_y_mm));
  say("MARKS FROM THE MIDDLE OF THE OPENING, IN MM:");
  for (const RegistrationMark& mark : registration_marks(options))
    say(mark.name + "   " + text("%+.2f   %+.2f", mark.place_mm.x(), mark.place_mm.y()));
  const double ruler = 2 * rim.opening.x() >= 110 ? 100 : 2 * rim.opening.x() >= 60 ? 50 : 5;
  const Vec2 from(-ruler / 2, -0.8 * rim.opening.y()), to(ruler / 2, from.y());
  drawing.line(from, to, 2 * outline_mm);
  for (const Vec2& end : {from, to}) drawing.line(end - Vec2(0, 2), end + Vec2(0, 2), outline_mm);
  drawing.label(from + Vec2(ruler / 2, 4), size, std::to_string(static_cast<int>(ruler)) + " MM");
  return drawing;
}

}  // namespace formwright
