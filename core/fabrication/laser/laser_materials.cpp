// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/laser/laser_materials.h"

namespace formwright {
namespace {

struct Values {
  double power_percent, speed_mm_per_s;
  int passes = 1;
};

LaserMaterial material(std::string name, std::string title, std::string laser, double thickness_mm, const Values& cut,
                       const Values& mark, const Values& engrave, double kerf_mm, bool air_assist,
                       std::string hint = "") {
  Json parameters = {{"cut_power_percent", cut.power_percent},
                     {"cut_speed_mm_per_s", cut.speed_mm_per_s},
                     {"cut_passes", cut.passes},
                     {"mark_power_percent", mark.power_percent},
                     {"mark_speed_mm_per_s", mark.speed_mm_per_s},
                     {"engrave_power_percent", engrave.power_percent},
                     {"engrave_speed_mm_per_s", engrave.speed_mm_per_s},
                     {"kerf_mm", kerf_mm},
                     {"air_assist", air_assist}};
  if (thickness_mm <= 0) parameters["cut_enabled"] = false;
  return {std::move(name), std::move(title), std::move(laser), thickness_mm, std::move(parameters), std::move(hint)};
}

}  // namespace

const std::vector<LaserMaterial>& laser_materials() {
  static const std::string co2 = "co2_40w", diode = "diode_10w";
  static const std::string melts =
      "Synthetic felt melts and may catch fire: stay beside it. Wool felt chars and smells.";
  static const std::string only_pmma =
      "Cast acrylic (PMMA) only; never PVC, whose fumes are poisonous and eat the machine.";
  static const std::vector<LaserMaterial> all = {
      material("felt_3_co2", "Felt 3 mm", co2, 3, {35, 20}, {12, 100}, {12, 150}, 0.25, true, melts),
      material("cotton_co2", "Cotton 0.5 mm", co2, 0.5, {15, 35}, {8, 120}, {8, 200}, 0.2, false,
               "Weigh it down flat: loose cloth flutters in the air."),
      material("card_co2", "Card 0.5 mm", co2, 0.5, {20, 35}, {8, 120}, {8, 200}, 0.15, true),
      material("paper_co2", "Paper 0.2 mm", co2, 0.2, {12, 50}, {6, 150}, {6, 250}, 0.12, false,
               "Little air, or it lifts."),
      material("cardboard_3_co2", "Corrugated board 3 mm", co2, 3, {40, 20}, {10, 100}, {12, 200}, 0.25, true,
               "Catches fire easily: stay beside it."),
      material("plywood_3_co2", "Plywood 3 mm", co2, 3, {80, 8}, {15, 80}, {20, 200}, 0.18, true,
               "Glues differ: test every sheet."),
      material("acrylic_3_co2", "Acrylic 3 mm", co2, 3, {80, 7}, {12, 80}, {18, 200}, 0.18, true, only_pmma),
      material("leather_2_co2", "Leather 2 mm", co2, 2, {55, 12}, {12, 100}, {15, 200}, 0.2, true,
               "Vegetable-tanned only: chrome tanning gives poisonous fumes."),
      material("engrave_wood_co2", "Engraving, wood", co2, 0, {0, 1}, {15, 80}, {20, 200}, 0.1, false),
      material("felt_3_diode", "Felt 3 mm", diode, 3, {80, 10, 2}, {25, 60}, {25, 80}, 0.2, true,
               melts + " Light colours take up little of a blue beam."),
      material("cotton_diode", "Cotton 0.5 mm", diode, 0.5, {50, 15}, {15, 80}, {15, 100}, 0.15, false,
               "Light colours take up little of a blue beam."),
      material("card_diode", "Card 0.5 mm", diode, 0.5, {70, 20}, {15, 80}, {20, 100}, 0.12, true),
      material("paper_diode", "Paper 0.2 mm", diode, 0.2, {40, 30}, {10, 100}, {12, 120}, 0.1, false),
      material("cardboard_3_diode", "Corrugated board 3 mm", diode, 3, {90, 10, 2}, {20, 60}, {25, 100}, 0.2, true,
               "Catches fire easily: stay beside it."),
      material("plywood_3_diode", "Plywood 3 mm", diode, 3, {100, 5, 2}, {30, 50}, {40, 80}, 0.15, true,
               "Glues differ: test every sheet."),
      material("acrylic_3_diode", "Acrylic 3 mm, dark", diode, 3, {100, 3, 2}, {40, 40}, {45, 60}, 0.15, true,
               only_pmma + " Clear and blue sheets let a blue beam through."),
      material("engrave_wood_diode", "Engraving, wood", diode, 0, {0, 1}, {30, 50}, {40, 80}, 0.1, false)};
  return all;
}

Json laser_materials_json() {
  Json list = Json::array();
  for (const LaserMaterial& m : laser_materials())
    list.push_back({{"name", m.name},
                    {"title", m.title},
                    {"laser", m.laser},
                    {"thickness_mm", m.thickness_mm},
                    {"parameters", m.parameters},
                    {"hint", m.hint}});
  return {{"note", "Values to begin with. Run a test grid and a kerf test on your material first."},
          {"lasers",
           {{{"name", "co2_40w"}, {"title", "CO2 tube, 40 W"}},
            {{"name", "diode_10w"}, {"title", "Diode, 10 W of light"}}}},
          {"materials", list}};
}

}  // namespace formwright
