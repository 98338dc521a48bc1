// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a maker decides about a mould: thesis 4.2.1 and 4.2.4 (step 3).
#include <array>
#include <optional>
#include <tuple>

#include "thermoform/sheet/thermoform_options.h"

namespace formwright {

enum class MouldKind { negative, positive };
template <>
struct EnumNames<MouldKind> {
  static constexpr std::array<std::string_view, 2> names{"negative", "positive"};
  static constexpr std::array<std::string_view, 2> labels{"Negative, to cast gypsum in", "Positive, to form over"};
};

enum class MouldOutline { box, hull };
template <>
struct EnumNames<MouldOutline> {
  static constexpr std::array<std::string_view, 2> names{"box", "hull"};
  static constexpr std::array<std::string_view, 2> labels{"Box", "Model's outline"};
};

struct ThermoformMouldOptions : ThermoformOptions {
  MouldKind kind = MouldKind::negative;
  double wall_mm = 3;
  MouldOutline outline = MouldOutline::box;
  double base_mm = 0;
  double base_rim_mm = 5;
  std::optional<double> foot_mm;
  int vents = 0;
  double vent_diameter_mm = 1;
  double vent_spacing_mm = 15;
  double water_to_plaster_ratio = 0.6;
  double printer_x_mm = 0;
  double printer_y_mm = 0;
  double printer_z_mm = 0;
  double key_diameter_mm = 4;
  double key_clearance_mm = 0.2;

  static constexpr auto parameters = std::tuple_cat(
      inherit_parameters<ThermoformMouldOptions>(ThermoformOptions::parameters),
      std::tuple{
          parameter(
              "kind", &ThermoformMouldOptions::kind, "Kind of mould",
              "Negative: 3D print a hollow block in PLA, pour gypsum into it and melt the PLA off; the gypsum cast stands the heat of forming. Positive: 3D print the shape itself in a heat-proof material.")
              .group("Mould"),
          parameter(
              "wall_mm", &ThermoformMouldOptions::wall_mm, "Wall", unit::mm, 0.4, 50,
              "Smallest wall thickness of the negative around the model. Thin walls melt off sooner; 3 mm is usual.")
              .group("Mould")
              .slider(1, 10),
          parameter(
              "outline", &ThermoformMouldOptions::outline, "Outside",
              "Outer shape of the negative: a rectangular box, or walls that follow the model's outline seen from above, which needs less plastic.")
              .group("Mould"),
          parameter(
              "base_mm", &ThermoformMouldOptions::base_mm, "Base plate", unit::mm, 0, 100,
              "Thickness of a plate under the cast or the positive. It gives the negative a wide opening to pour into, and raises the model by the same height in the machine. 0: no plate.")
              .group("Mould")
              .slider(0, 20),
          parameter("base_rim_mm", &ThermoformMouldOptions::base_rim_mm, "Base rim", unit::mm, 0, 100,
                    "How far the base plate extends beyond the model on each side.")
              .group("Mould")
              .slider(0, 20),
          parameter(
              "foot_mm", &ThermoformMouldOptions::foot_mm, "Straight foot", unit::mm, 0, 100,
              "Height below which the walls go straight down to the plate, which gives round undersides a flat foot. Automatic: about 1 mm if the model would otherwise touch the plate in little more than a point, else none.")
              .group("Mould")
              .slider(0, 10),
          parameter(
              "vents", &ThermoformMouldOptions::vents, "Vent holes", unit::none, 0, 100,
              "Number of air holes through the mould, placed by simulation where the sheet arrives last. 0: none, and no simulation is needed.")
              .group("Mould")
              .slider(0, 24),
          parameter(
              "vent_diameter_mm", &ThermoformMouldOptions::vent_diameter_mm, "Vent diameter", unit::mm, 0.2, 10,
              "Diameter of the air holes. Holes wider than the sheet is thick leave visible marks; 1 mm is usual. In a negative they are pins that leave holes in the cast.")
              .group("Mould")
              .slider(0.5, 3),
          parameter("vent_spacing_mm", &ThermoformMouldOptions::vent_spacing_mm, "Vent spacing", unit::mm, 1, 500,
                    "Smallest distance between the centres of two air holes; never less than twice their diameter.")
              .group("Mould")
              .slider(5, 50),
          parameter(
              "water_to_plaster_ratio", &ThermoformMouldOptions::water_to_plaster_ratio, "Water to plaster", unit::none,
              0.2, 2,
              "Water divided by gypsum powder, by weight: 0.6 is 60 g of water for 100 g of powder. The bag of gypsum states it. Less water makes a harder cast that lets less air through.")
              .group("Mould")
              .slider(0.3, 1),
          parameter("printer_x_mm", &ThermoformMouldOptions::printer_x_mm, "Printer width", unit::mm, 0, 5000,
                    "Width that the 3D printer can print. Larger moulds are cut into parts that fit. 0: no limit.")
              .group("Mould")
              .slider(0, 500),
          parameter(
              "printer_y_mm", &ThermoformMouldOptions::printer_y_mm, "Printer depth", unit::mm, 0, 5000,
              "Depth, front to back, that the 3D printer can print. Larger moulds are cut into parts that fit. 0: no limit.")
              .group("Mould")
              .slider(0, 500),
          parameter("printer_z_mm", &ThermoformMouldOptions::printer_z_mm, "Printer height", unit::mm, 0, 5000,
                    "Height that the 3D printer can print. Larger moulds are cut into parts that fit. 0: no limit.")
              .group("Mould")
              .slider(0, 500),
          parameter(
              "key_diameter_mm", &ThermoformMouldOptions::key_diameter_mm, "Key diameter", unit::mm, 0, 50,
              "Diameter of the pins and sockets that align the parts of a mould; smaller ones are made where walls are thin. 4 mm is usual; 0: none.")
              .group("Mould")
              .slider(0, 10)
              .advanced(),
          parameter("key_clearance_mm", &ThermoformMouldOptions::key_clearance_mm, "Key clearance", unit::mm, 0, 2,
                    "Gap between each pin and its socket. More is looser; 0.2 mm is usual.")
              .group("Mould")
              .slider(0, 0.6)
              .advanced()});
};

}  // namespace formwright
