// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/models/thermoform/rim_thickness.h"

#include <cmath>

#include "base/format.h"

namespace formwright {

bool is_on_rim(const Vec2& sheet_mm, const ThermoformOptions& o) {
  return std::abs(sheet_mm.x()) > 0.5 * o.clamp_opening_x_mm || std::abs(sheet_mm.y()) > 0.5 * o.clamp_opening_y_mm;
}

std::vector<RimPlace> rim_places(const ThermoformOptions& o) {
  constexpr double min_rim_mm = 2;  // that calipers grip
  std::vector<RimPlace> places;
  if (0.5 * (o.sheet_x_mm - o.clamp_opening_x_mm) >= min_rim_mm) {
    const double x = 0.25 * (o.sheet_x_mm + o.clamp_opening_x_mm);
    places.push_back({"left", Vec2(-x, 0)});
    places.push_back({"right", Vec2(x, 0)});
  }
  if (0.5 * (o.sheet_y_mm - o.clamp_opening_y_mm) >= min_rim_mm) {
    const double y = 0.25 * (o.sheet_y_mm + o.clamp_opening_y_mm);
    places.push_back({"front", Vec2(0, -y)});
    places.push_back({"back", Vec2(0, y)});
  }
  return places;
}

std::string thickness_note(const FormedObject& object) {
  constexpr double min_difference = 0.04;  // of the sheet: what a sheet may differ from its label without a word
  const auto o = read_parameters<ThermoformOptions>(object.setup.parameters);
  // A sheet that is thicker on one side is as much thinner on the other: only the mean of opposite places counts.
  double sum = 0, sigma = 0;
  int sides = 0;
  for (int axis = 0; axis < 2; ++axis) {
    const double half = 0.5 * (axis == 0 ? o.clamp_opening_x_mm : o.clamp_opening_y_mm);
    double below = 0, above = 0;
    int count_below = 0, count_above = 0;
    for (const MeasuredThickness& reading : object.thickness) {
      if (reading.sheet_mm[axis] < -half) below += reading.thickness_mm, ++count_below;
      if (reading.sheet_mm[axis] > half) above += reading.thickness_mm, ++count_above;
      sigma = std::max(sigma, reading.sigma_mm);
    }
    if (count_below == 0 || count_above == 0) continue;
    sum += 0.5 * (below / count_below + above / count_above);
    ++sides;
  }
  if (sides == 0) return {};
  const double found = sum / sides, off = found - o.sheet_thickness_mm;
  if (std::abs(off) < std::max(min_difference * o.sheet_thickness_mm, 2 * sigma)) return {};
  return "The rim is " + with_digits(found, 3) + " mm thick, and setup.json has " +
         with_digits(o.sheet_thickness_mm, 3) + " mm: correct its sheet_thickness_mm and diagnose again.";
}

}  // namespace formwright
