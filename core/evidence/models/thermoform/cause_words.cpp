// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/models/thermoform/cause_words.h"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/format.h"
#include "thermoform/contact/contact_chill.h"

namespace formwright {
namespace {

/// "12 %": digits that a maker can act on.
std::string percent(double share) {
  const double size = 100 * std::abs(share);
  return with_digits(size, size < 100 ? 2 : 3) + " %";
}

std::string millimetres(double length) { return with_digits(std::abs(length), 2) + " mm"; }

/// Of the opening seen from above: x to the right, y to the back. By eighths of a turn.
std::string side(double x, double y) {
  constexpr std::array<const char*, 8> names{"on the right", "at the back right", "at the back",  "at the back left",
                                             "on the left",  "at the front left", "at the front", "at the front right"};
  const double eighth = std::atan2(y, x) / (std::numbers::pi / 4);
  return names[static_cast<std::size_t>((static_cast<int>(std::lround(eighth)) + 8) % 8)];
}

/// How much a linear change amounts to where it is strongest: in the corner or at the side that side() names.
double strongest(double x, double y) {
  const double along = std::max(std::abs(x), std::abs(y)), across = std::min(std::abs(x), std::abs(y));
  return across > std::tan(std::numbers::pi / 8) * along ? along + across : along;
}

/// "2 mm to the right and 1.5 mm to the front"; components that hardly matter are left out.
std::string way(std::span<const double> by) {
  constexpr std::array<std::array<const char*, 2>, 3> names{
      {{"to the right", "to the left"}, {"to the back", "to the front"}, {"up", "down"}}};
  double largest = 0;
  for (const double value : by) largest = std::max(largest, std::abs(value));
  std::vector<std::string> parts;
  for (std::size_t k = 0; k < by.size() && k < names.size(); ++k)
    if (std::abs(by[k]) > 0.15 * largest) parts.push_back(millimetres(by[k]) + " " + names[k][by[k] < 0]);
  std::string text;
  for (std::size_t i = 0; i < parts.size(); ++i)
    text += (i == 0 ? "" : i + 1 == parts.size() ? " and " : ", ") + parts[i];
  return text;
}

std::string degrees(double angle) { return with_digits(std::abs(angle), 2) + "°"; }

/// "leans by 0.7°, too high on the left, and is turned by 1°, clockwise seen from above", by angles about x, y and z;
/// the smaller of the two is left out where it hardly matters.
std::string turned(std::span<const double> by) {
  const double x = by[0], y = by.size() > 1 ? by[1] : 0, z = by.size() > 2 ? by[2] : 0, lean = std::hypot(x, y);
  const std::string leans = "leans by " + degrees(lean) + ", too high " + side(-y, x);
  const std::string turns =
      "is turned by " + degrees(z) + (z > 0 ? ", counter-clockwise" : ", clockwise") + " seen from above";
  constexpr double hardly = 0.15;
  if (std::abs(z) <= hardly * lean) return leans;
  if (lean <= hardly * std::abs(z)) return turns;
  return leans + ", and " + turns;
}

}  // namespace

std::string thermoform_cause_in_words(std::string_view cause, std::span<const double> values) {
  if (values.empty()) return "";
  const double v = values[0];
  const auto two = [&] { return values.size() > 1 ? values[1] : 0.0; };
  if (cause == "heating_gradient")
    return "The sheet was hotter " + side(-v, -two()) + ": about " + percent(strongest(v, two())) +
           " softer there than in its middle.";
  if (cause == "heating_centre")
    return std::string("The corners of the sheet were ") + (v > 0 ? "colder" : "hotter") + " than its middle: about " +
           percent(v) + (v > 0 ? " stiffer" : " softer") + " than on average.";
  if (cause == "slip")
    return "The sheet slid on the mould instead of sticking, as with a coefficient of friction of about " +
           with_digits(1 / std::max(v, 1e-3), 2) + ".";
  if (cause == "anisotropy")
    return std::string("The sheet was about ") + percent(v) + " stiffer " +
           (v > 0 ? "from side to side, and as much softer from front to back."
                  : "from front to back, and as much softer from side to side.");
  if (cause == "thickness_wedge")
    return "The flat sheet was thicker " + side(v, two()) + ": about " + percent(strongest(v, two())) +
           " more there than in its middle.";
  if (cause == "cooling")
    return "The mould chilled the sheet: where it touched, the sheet became up to " +
           with_digits(1 + chilled_stiffness * v, 2) + " times as stiff.";
  if (cause == "weak_vacuum") return "About " + percent(v) + " of the vacuum did not reach the sheet.";
  if (cause == "clamp_slip")
    return "The sheet's rim was drawn in from under the clamp by up to about " + millimetres(v) + ".";
  if (cause == "mould_shift") return "The mould stood about " + way(values) + " of its place.";
  if (cause == "mould_rotation")
    return "The mould stood turned by about " + degrees(v) + ", " + (v > 0 ? "counter-clockwise" : "clockwise") +
           " seen from above.";
  if (cause == "mould_scale")
    return "The mould was about " + percent(v) + (v > 0 ? " larger" : " smaller") + " than its model.";
  if (cause == "print_scale")
    return "The pattern was printed about " + percent(v) + (v > 0 ? " too large." : " too small.");
  if (cause == "print_stretch_x" || cause == "print_stretch_y")
    return "The pattern was printed about " + percent(v) + (v > 0 ? " too long" : " too short") +
           (cause == "print_stretch_x" ? " from side to side." : " from front to back.");
  if (cause == "scan_scale")
    return "The scan is about " + percent(v) + (v > 0 ? " larger" : " smaller") + " than the object.";
  if (cause == "scan_stretch_x" || cause == "scan_stretch_y")
    return "The scan is about " + percent(v) + (v > 0 ? " too long" : " too short") +
           (cause == "scan_stretch_x" ? " from side to side." : " from front to back.");
  if (cause == "scan_stretch_z") return "The scan is about " + percent(v) + (v > 0 ? " too high." : " too low.");
  if (cause == "scan_rotation") return "The scan " + turned(values) + ".";
  if (cause == "scan_shift") return "The scan lies about " + way(values) + " from where the object was.";
  return "";
}

}  // namespace formwright
