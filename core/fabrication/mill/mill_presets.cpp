// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/mill/mill_presets.h"

namespace formwright {
namespace {

struct Feeds {
  double spindle_rpm, rough_speed_mm_per_s, finish_speed_mm_per_s, plunge_speed_mm_per_s, step_down_mm;
};

Preset material(std::string name, std::string title, const Feeds& feeds, std::string hint = "") {
  return {std::move(name),
          std::move(title),
          {{"spindle_rpm", feeds.spindle_rpm},
           {"rough_speed_mm_per_s", feeds.rough_speed_mm_per_s},
           {"finish_speed_mm_per_s", feeds.finish_speed_mm_per_s},
           {"plunge_speed_mm_per_s", feeds.plunge_speed_mm_per_s},
           {"step_down_mm", feeds.step_down_mm}},
          std::move(hint)};
}

}  // namespace

PresetList mill_material_presets() {
  return {
      "material",
      "Material",
      "Sets speeds, depth of a pass and spindle for tools 3 mm wide with two edges. Try them on a piece of waste first; thinner tools and lighter machines need less.",
      "Feeds",
      {material("softwood", "Softwood", {12'000, 15, 20, 5, 1.5}),
       material("hardwood", "Hardwood, plywood", {14'000, 13, 18, 4, 1}),
       material("mdf", "MDF", {12'000, 16, 22, 5, 1.5}, "Its fine dust harms lungs: extract it and wear a mask."),
       material("foam", "Modelling foam", {10'000, 30, 40, 15, 3}),
       material("wax", "Carving wax", {10'000, 20, 30, 8, 2}),
       material("acrylic", "Acrylic, cast", {12'000, 12, 16, 3, 0.8},
                "Chips that melt clog the tool: blow them away, and never let it stand still.")}};
}

}  // namespace formwright
