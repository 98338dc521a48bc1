// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/sheet/sheet_presets.h"

#include <array>

namespace formwright {
namespace {

/// Usual densities of unfilled grades. Stiffness is left out: no source for these plastics at forming temperature is
/// known.
Preset plastic(std::string name, std::string title, double density_kg_per_m3, std::string hint) {
  return {std::move(name), std::move(title), {{"density_kg_per_m3", density_kg_per_m3}}, std::move(hint)};
}

/// The sheet is clamped all round: the opening is smaller than the sheet by the rim.
Preset former(std::string name, std::string title, std::array<double, 2> sheet_mm, double rim_mm, double depth_mm,
              double vacuum_kpa, std::string hint = "") {
  return {std::move(name),
          std::move(title),
          {{"sheet_x_mm", sheet_mm[0]},
           {"sheet_y_mm", sheet_mm[1]},
           {"clamp_opening_x_mm", sheet_mm[0] - 2 * rim_mm},
           {"clamp_opening_y_mm", sheet_mm[1] - 2 * rim_mm},
           {"platform_travel_mm", depth_mm},
           {"vacuum_kpa", vacuum_kpa}},
          std::move(hint)};
}

}  // namespace

std::vector<PresetList> sheet_presets() {
  static const std::string dry = "Dry the sheet first, or it bubbles.";
  static const std::string cleaner = "Pulled by a vacuum cleaner: fine detail comes out softer than with a pump.";
  return {
      {"former",
       "Vacuum former",
       "Sets the sheet, the clamp's opening, the depth of the box and the vacuum of a usual machine of this size. Measure yours and correct what differs.",
       "Machine",
       {former("sheet_240_260", "Sheets of 240 × 260 mm, pump", {240, 260}, 10, 120, 80),
        former("sheet_a4_cleaner", "Sheets of A4, vacuum cleaner", {210, 297}, 10, 100, 20, cleaner),
        former("sheet_220_220_cleaner", "Sheets of 220 × 220 mm, vacuum cleaner", {220, 220}, 10, 130, 20, cleaner),
        former("sheet_300_450", "Sheets of 300 × 450 mm, pump", {300, 450}, 10, 160, 85),
        former("sheet_450_450", "Sheets of 450 × 450 mm, pump", {450, 450}, 10, 185, 85),
        former("sheet_508_457", "Sheets of 508 × 457 mm, pump", {508, 457}, 12, 250, 90)}},
      {"plastic",
       "Plastic",
       "Sets the density, and so the weight that makes the hot sheet sag. How soft it is depends on its heating more than on the plastic: fit that to a part of your own in Evidence.",
       "Sheet",
       {plastic("pvc", "PVC, rigid", 1330,
                "Formed at about 110 to 140 °C. Overheated it gives off hydrochloric acid: air the room."),
        plastic("petg", "PETG", 1270, "Formed at about 120 to 160 °C, without drying."),
        plastic("hips", "HIPS (polystyrene)", 1050, "Formed at about 130 to 175 °C. The easiest to begin with."),
        plastic("abs", "ABS", 1050, "Formed at about 140 to 180 °C. " + dry),
        plastic("pc", "PC (polycarbonate)", 1200, "Formed at about 170 to 205 °C. " + dry),
        plastic("acrylic", "Acrylic (PMMA)", 1190,
                "Formed at about 150 to 190 °C. Extruded sheets form more easily than cast ones.")}}};
}

}  // namespace formwright
