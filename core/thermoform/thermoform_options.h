// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The sheet, its material and the machine: thesis 4.2.2 and 4.2.3, with the defaults calibrated there.
#include <array>
#include <optional>
#include <tuple>

#include "base/parameters.h"
#include "thermoform/sheet_effects.h"

namespace formwright {

enum class ElasticLaw { st_venant_kirchhoff, stable_neo_hookean };
template <>
struct EnumNames<ElasticLaw> {
  static constexpr std::array<std::string_view, 2> names{"st_venant_kirchhoff", "stable_neo_hookean"};
  static constexpr std::array<std::string_view, 2> labels{"St. Venant-Kirchhoff", "Stable neo-Hookean"};
};

enum class YieldRule { elastic_excess, total_strain };
template <>
struct EnumNames<YieldRule> {
  static constexpr std::array<std::string_view, 2> names{"elastic_excess", "total_strain"};
  static constexpr std::array<std::string_view, 2> labels{"Elastic excess", "Total strain"};
};

/// What thermoform-simulate takes: the model's placement, what is clamped into the machine, what that does with it, and
/// what it does beside.
struct ThermoformOptions : SheetEffects {
  double sheet_x_mm = 240;
  double sheet_y_mm = 260;
  double sheet_thickness_mm = 1;
  double clamp_opening_x_mm = 220;
  double clamp_opening_y_mm = 240;
  double clamp_height_mm = 1;
  double platform_travel_mm = 120;
  double relaxation_s = 1;
  double mould_speed_mm_per_s = 100;
  double vacuum_kpa = 80;
  double vacuum_ramp_s = 0.2;
  double time_limit_s = 5;
  double young_modulus_pa = 2.75e6;
  double creep_per_s = 500;
  double yield_strain = 0.1;
  double viscosity_s = 2.5e-5;
  double poisson_ratio = 0.35;
  double density_kg_per_m3 = 1330;
  ElasticLaw elastic_law = ElasticLaw::st_venant_kirchhoff;
  YieldRule yield_rule = YieldRule::elastic_excess;
  double flow_stop_mm = 0.2;
  bool bending = false;
  int triangles = 10000;
  std::optional<double> step_mm;
  int frames = 24;

  static constexpr auto parameters = std::tuple_cat(
      inherit_parameters<ThermoformOptions>(PlacementOptions::parameters),
      std::tuple{
          parameter("sheet_thickness_mm", &ThermoformOptions::sheet_thickness_mm, "Thickness", unit::mm, 0.05, 10,
                    "Thickness of the flat sheet.")
              .group("Sheet")
              .slider(0.25, 3),
          parameter("sheet_x_mm", &ThermoformOptions::sheet_x_mm, "Sheet width", unit::mm, 10, 3000,
                    "Width of the flat sheet, clamped rim included.")
              .group("Sheet")
              .slider(100, 600),
          parameter("sheet_y_mm", &ThermoformOptions::sheet_y_mm, "Sheet length", unit::mm, 10, 3000,
                    "Length of the flat sheet, clamped rim included.")
              .group("Sheet")
              .slider(100, 600),
          parameter("clamp_opening_x_mm", &ThermoformOptions::clamp_opening_x_mm, "Opening width", unit::mm, 10, 3000,
                    "Width of the clamp's opening: the part of the sheet that is free to move.")
              .group("Machine")
              .slider(80, 580),
          parameter("clamp_opening_y_mm", &ThermoformOptions::clamp_opening_y_mm, "Opening length", unit::mm, 10, 3000,
                    "Length of the clamp's opening: the part of the sheet that is free to move.")
              .group("Machine")
              .slider(80, 580),
          parameter("vacuum_kpa", &ThermoformOptions::vacuum_kpa, "Vacuum", unit::kilopascal, 0, 101.3,
                    "Pressure difference that pulls the sheet onto the model.")
              .group("Machine")
              .slider(10, 100),
          parameter(
              "vacuum_ramp_s",
              &ThermoformOptions::vacuum_ramp_s, "Vacuum builds up in", unit::seconds, 0, 5,
              "Time in which the vacuum grows from nothing to full. 0 is the thesis's assumption of an instant vacuum.")
              .group("Machine")
              .slider(0, 1),
          parameter("mould_speed_mm_per_s", &ThermoformOptions::mould_speed_mm_per_s, "Raise speed", unit::mm_per_s, 1,
                    2000, "How fast the platform carries the model up into the sheet.")
              .group("Machine")
              .slider(10, 300),
          parameter(
              "platform_travel_mm", &ThermoformOptions::platform_travel_mm, "Box depth", unit::mm, 1, 2000,
              "How far below its final place the platform starts. Models must be lower than this, less the sag of the sheet.")
              .group("Machine")
              .slider(20, 300),
          parameter("clamp_height_mm", &ThermoformOptions::clamp_height_mm, "Clamp height", unit::mm, 0, 500,
                    "How high above the raised base plate the middle of the clamped sheet lies.")
              .group("Machine")
              .slider(0, 30)
              .advanced(),
          parameter("relaxation_s", &ThermoformOptions::relaxation_s, "Relaxation", unit::seconds, 0, 60,
                    "How long the hot sheet sags before the platform moves.")
              .group("Machine")
              .slider(0, 5)
              .advanced(),
          parameter("time_limit_s", &ThermoformOptions::time_limit_s, "Time limit", unit::seconds, 0.01, 60,
                    "The vacuum is held this long at most; the simulation ends sooner once nothing moves.")
              .group("Machine")
              .slider(1, 10)
              .advanced(),
          parameter("young_modulus_pa", &ThermoformOptions::young_modulus_pa, "Young's modulus", unit::pascal, 1e4, 1e9,
                    "Stiffness of the hot sheet (Y). Calibrated in the thesis.")
              .group("Material")
              .slider(5e5, 5e6),
          parameter("yield_strain", &ThermoformOptions::yield_strain, "Yield strain", unit::none, 0, 2,
                    "Elastic strain beyond which the sheet flows (c_yield). Calibrated in the thesis.")
              .group("Material")
              .slider(0, 0.2),
          parameter("creep_per_s", &ThermoformOptions::creep_per_s, "Creep", unit::per_second, 0, 1e5,
                    "How fast strain beyond the yield strain becomes permanent (c_creep). Calibrated in the thesis.")
              .group("Material")
              .slider(0, 1000),
          parameter("viscosity_s", &ThermoformOptions::viscosity_s, "Viscosity", unit::seconds, 0, 10,
                    "Resistance to fast stretching, as a time times the elastic stiffness. Calibrated in the thesis.")
              .group("Material")
              .slider(0, 1e-4),
          parameter("poisson_ratio", &ThermoformOptions::poisson_ratio, "Poisson's ratio", unit::none, 0, 0.49,
                    "How much the sheet narrows when it is stretched.")
              .group("Material")
              .advanced(),
          parameter("density_kg_per_m3", &ThermoformOptions::density_kg_per_m3, "Density", unit::kg_per_m3, 10, 30000,
                    "Of the plastic.")
              .group("Material")
              .slider(800, 2000)
              .advanced(),
          parameter(
              "elastic_law", &ThermoformOptions::elastic_law, "Elastic law",
              "St. Venant-Kirchhoff as in the thesis, or stable neo-Hookean, which does not soften when compressed.")
              .group("Material")
              .advanced(),
          parameter(
              "yield_rule", &ThermoformOptions::yield_rule, "Yield rule",
              "Elastic excess: only elastic strain beyond the yield strain flows; converges with finer sheets. Total strain: the thesis's sentence taken literally; yielded parts flow until they neck.")
              .group("Material")
              .advanced(),
          parameter("flow_stop_mm", &ThermoformOptions::flow_stop_mm, "Flow stops at", unit::mm, 0, 10,
                    "Where the sheet has become this thin it no longer flows or softens, as drawn-out plastic hardens.")
              .group("Material")
              .slider(0, 0.5)
              .advanced(),
          parameter("bending", &ThermoformOptions::bending, "Bending stiffness",
                    "Adds the hinge energy. Moves points about 0.1 mm and takes two to three times as long.")
              .group("Accuracy")
              .advanced(),
          parameter("triangles", &ThermoformOptions::triangles, "Triangles", unit::none, 200, 400000,
                    "How finely the sheet is divided; rounded to a whole grid.")
              .group("Accuracy")
              .slider(1000, 40000),
          parameter(
              "step_mm", &ThermoformOptions::step_mm, "Step", unit::mm, 0.05, 20,
              "How far the sheet may move in one time step. Automatic: 1 mm, or 0.3 of a triangle's edge where that is more.")
              .group("Accuracy")
              .slider(0.25, 4)
              .advanced(),
          parameter("frames", &ThermoformOptions::frames, "Frames", unit::none, 2, 200, "Pictures in the animation.")
              .group("Accuracy")
              .slider(8, 60)
              .advanced()},
      inherit_parameters<ThermoformOptions>(SheetEffects::parameters));
};

/// The part of the sheet that shows in the clamp's opening.
inline Vec2 clamp_opening_mm(const ThermoformOptions& options) {
  return {options.clamp_opening_x_mm, options.clamp_opening_y_mm};
}

}  // namespace formwright
