// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/zipping/cloth_presets.h"

namespace formwright {
namespace {

Preset cloth(std::string name, std::string title, double thickness_mm, double stretch_n_per_mm, double bending_n_mm) {
  return {std::move(name),
          std::move(title),
          {{"thickness_mm", thickness_mm}, {"stretch_n_per_mm", stretch_n_per_mm}, {"bending_n_mm", bending_n_mm}}};
}

}  // namespace

PresetList cloth_presets() {
  return {
      "cloth",
      "Cloth",
      "Sets thickness, stretch and bending stiffness of a usual cloth of this kind. Cloths of one name differ by a factor of two.",
      "Cloth",
      {cloth("cotton", "Cotton, woven", 0.5, 10, 0.01), cloth("denim", "Denim", 0.9, 15, 0.04),
       cloth("felt", "Craft felt, 3 mm", 3, 1, 0.3), cloth("fleece", "Fleece", 2.5, 2, 0.02),
       cloth("jersey", "Jersey, knitted", 0.8, 1.5, 0.003)}};
}

}  // namespace formwright
