// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The sheet, its material and the machine: thesis 4.2.2 and 4.2.3, with the defaults calibrated there.
#include <array>
#include <optional>
#include <tuple>

#include "base/data/parameters.h"
#include "thermoform/sheet/sheet_effects.h"

namespace formwright {

enum class ElasticLaw { st_venant_kirchhoff, stable_neo_hookean, incompressible_neo_hookean };
template <>
struct EnumNames<ElasticLaw> {
  static constexpr std::array<std::string_view, 3> names{"st_venant_kirchhoff", "stable_neo_hookean",
                                                         "incompressible_neo_hookean"};
  static constexpr std::array<std::string_view, 3> labels{"St. Venant-Kirchhoff", "Stable neo-Hookean",
                                                          "Incompressible neo-Hookean"};
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
  double network_share = 0;
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
          parameter(
              "sheet_thickness_mm", &ThermoformOptions::sheet_thickness_mm, "Thickness", unit::mm, 0.05, 10,
              "Thickness of the flat plastic sheet before heating. 1 mm is usual; thicker sheets tear less and show less detail.")
              .group("Sheet")
              .slider(0.25, 3),
          parameter("sheet_x_mm", &ThermoformOptions::sheet_x_mm, "Sheet width", unit::mm, 10, 3000,
                    "Width of the flat sheet, including the rim held by the clamp.")
              .group("Sheet")
              .slider(100, 600),
          parameter("sheet_y_mm", &ThermoformOptions::sheet_y_mm, "Sheet length", unit::mm, 10, 3000,
                    "Length of the flat sheet, front to back, including the rim held by the clamp.")
              .group("Sheet")
              .slider(100, 600),
          parameter("clamp_opening_x_mm", &ThermoformOptions::clamp_opening_x_mm, "Opening width", unit::mm, 10, 3000,
                    "Width of the clamp's opening: the part of the sheet that is free to move.")
              .group("Machine")
              .slider(80, 580),
          parameter("clamp_opening_y_mm", &ThermoformOptions::clamp_opening_y_mm, "Opening length", unit::mm, 10, 3000,
                    "Length of the clamp's opening, front to back: the part of the sheet that is free to move.")
              .group("Machine")
              .slider(80, 580),
          parameter(
              "vacuum_kpa", &ThermoformOptions::vacuum_kpa, "Vacuum", unit::kilopascal, 0, 101.3,
              "Pressure difference that pulls the sheet onto the model. More vacuum follows fine detail better; 80 kPa is usual.")
              .group("Machine")
              .slider(10, 100),
          parameter("vacuum_ramp_s", &ThermoformOptions::vacuum_ramp_s, "Vacuum builds up in", unit::seconds, 0, 5,
                    "Time that the vacuum takes to reach its full value. 0.2 s is usual; 0 applies it at once.")
              .group("Machine")
              .slider(0, 1)
              .advanced(),
          parameter("mould_speed_mm_per_s", &ThermoformOptions::mould_speed_mm_per_s, "Raise speed", unit::mm_per_s, 1,
                    2000, "Speed at which the platform carries the model up into the sheet.")
              .group("Machine")
              .slider(10, 300)
              .advanced(),
          parameter(
              "platform_travel_mm", &ThermoformOptions::platform_travel_mm, "Box depth", unit::mm, 1, 2000,
              "How far the platform starts below its top position. The model must be lower than this minus the sag of the sheet.")
              .group("Machine")
              .slider(20, 300),
          parameter("clamp_height_mm", &ThermoformOptions::clamp_height_mm, "Clamp height", unit::mm, 0, 500,
                    "Height of the middle of the clamped sheet above the raised base plate.")
              .group("Machine")
              .slider(0, 30)
              .advanced(),
          parameter("relaxation_s", &ThermoformOptions::relaxation_s, "Sag time", unit::seconds, 0, 60,
                    "How long the hot sheet sags under its own weight before the platform moves.")
              .group("Machine")
              .slider(0, 5)
              .advanced(),
          parameter("time_limit_s", &ThermoformOptions::time_limit_s, "Time limit", unit::seconds, 0.01, 60,
                    "Longest time that the vacuum is applied. The simulation ends sooner if the sheet stops moving.")
              .group("Machine")
              .slider(1, 10)
              .advanced(),
          parameter(
              "young_modulus_pa", &ThermoformOptions::young_modulus_pa, "Young's modulus", unit::pascal, 1e4, 1e9,
              "Stiffness of the hot sheet. A larger value resists stretching more, like a cooler sheet; 2,750,000 Pa (2.75 MPa) was measured for one hot sheet 1 mm thick.")
              .group("Material")
              .slider(5e5, 5e6),
          parameter(
              "yield_strain", &ThermoformOptions::yield_strain, "Yield strain", unit::none, 0, 2,
              "Elastic strain beyond which the hot sheet flows and stays deformed. 0.1 means that the sheet springs back from up to 10 % stretch.")
              .group("Material")
              .slider(0, 0.2),
          parameter(
              "creep_per_s", &ThermoformOptions::creep_per_s, "Creep rate", unit::per_second, 0, 1e5,
              "How fast stretch beyond the yield strain becomes permanent. Larger values flow sooner; 500 per second makes it permanent within a few milliseconds.")
              .group("Material")
              .slider(0, 1000),
          parameter(
              "viscosity_s", &ThermoformOptions::viscosity_s, "Viscosity", unit::seconds, 0, 10,
              "Resistance to fast stretching, in seconds: the viscous stress at a strain rate of 1/s divided by the elastic stiffness. Larger values slow the sheet down; 0 is none.")
              .group("Material")
              .slider(0, 1e-4),
          parameter(
              "network_share", &ThermoformOptions::network_share, "Stiffness that never flows", unit::none, 0, 1,
              "Share of the stiffness that keeps pulling however far the sheet is drawn, as rubber does. 0: all flows, so that steep walls draw very thin; more keeps them thicker. 1 is rubber.")
              .group("Material")
              .slider(0, 0.5)
              .advanced(),
          parameter(
              "poisson_ratio", &ThermoformOptions::poisson_ratio, "Poisson's ratio", unit::none, 0, 0.49,
              "How much the sheet narrows when it is stretched, as a fraction of the stretch. 0.35 is usual for hot plastic.")
              .group("Material")
              .advanced(),
          parameter(
              "density_kg_per_m3", &ThermoformOptions::density_kg_per_m3, "Density", unit::kg_per_m3, 10, 30000,
              "Density of the plastic, which sets its weight and so its sag. Polystyrene about 1050, PVC and PETG 1270 to 1400 kg/m³.")
              .group("Material")
              .slider(800, 2000)
              .advanced(),
          parameter(
              "elastic_law", &ThermoformOptions::elastic_law, "Elastic law",
              "Formula for the elastic force. St. Venant-Kirchhoff is the standard one here; stable neo-Hookean does not soften when the sheet is compressed; incompressible neo-Hookean keeps the plastic's volume, as rubber does, so that a stretch in two directions takes more force than in one.")
              .group("Material")
              .advanced(),
          parameter(
              "yield_rule", &ThermoformOptions::yield_rule, "Yield rule",
              "Which strain flows. Elastic excess: only elastic strain above the yield strain, which gives the same result on finer sheets. Total strain: everything once yielded, so that stretched places thin to a neck.")
              .group("Material")
              .advanced(),
          parameter(
              "flow_stop_mm", &ThermoformOptions::flow_stop_mm, "Stop flowing at", unit::mm, 0, 10,
              "Thickness at which the sheet no longer flows or softens, as drawn-out plastic hardens. 0 never stops it.")
              .group("Material")
              .slider(0, 0.5)
              .advanced(),
          parameter(
              "bending", &ThermoformOptions::bending, "Bending stiffness",
              "Also computes the sheet's resistance to bending. Moves points by about 0.1 mm and takes two to three times as long.")
              .group("Accuracy")
              .advanced(),
          parameter(
              "triangles", &ThermoformOptions::triangles, "Triangles", unit::none, 200, 400000,
              "Number of triangles in the simulated sheet, rounded to a whole grid. More show finer detail and take longer: 2,500 for a quick look, 10,000 for the result.")
              .group("Accuracy")
              .slider(1000, 40000),
          parameter(
              "step_mm", &ThermoformOptions::step_mm, "Largest step", unit::mm, 0.05, 20,
              "How far the sheet may move in one time step. Smaller is more accurate and slower. Automatic: 1 mm, or 0.3 of a triangle's edge if that is more.")
              .group("Accuracy")
              .slider(0.25, 4)
              .advanced(),
          parameter("frames", &ThermoformOptions::frames, "Frames", unit::none, 2, 200,
                    "Number of pictures in the animation.")
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
