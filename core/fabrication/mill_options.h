// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How a mill carves a height field.
#include "fabrication/machine_options.h"

namespace formwright {

enum class ToolShape { ball, v, flat };
template <>
struct EnumNames<ToolShape> {
  static constexpr std::array<std::string_view, 3> names{"ball", "v", "flat"};
  static constexpr std::array<std::string_view, 3> labels{"Ball", "V", "Flat"};
};

enum class MillStages { both, rough, finish };
template <>
struct EnumNames<MillStages> {
  static constexpr std::array<std::string_view, 3> names{"both", "rough", "finish"};
  static constexpr std::array<std::string_view, 3> labels{"Roughing and finishing", "Roughing only", "Finishing only"};
};

enum class RasterAlong { x, y };
template <>
struct EnumNames<RasterAlong> {
  static constexpr std::array<std::string_view, 2> names{"x", "y"};
  static constexpr std::array<std::string_view, 2> labels{"x", "y"};
};

struct MillOptions : MachineOptions {
  MillOptions() {
    controller = Controller::grbl_mill;
    travel_speed_mm_per_s = 40;
    acceleration_mm_per_s2 = 150;
  }
  double x_mm = 0, y_mm = 0;
  std::optional<double> width_mm;
  double thickness_mm = 5, pixel_mm = 0.1, stock_over_mm = 0, path_tolerance_mm = 0.01;
  MillStages stages = MillStages::both;
  ToolShape tool = ToolShape::ball;
  double diameter_mm = 3, v_angle_degrees = 60, v_tip_mm = 0.1;
  double finish_stepover_percent = 12, finish_speed_mm_per_s = 20;
  RasterAlong finish_along = RasterAlong::x;
  ToolShape rough_tool = ToolShape::flat;
  double rough_diameter_mm = 3, rough_stepover_percent = 45, rough_speed_mm_per_s = 15;
  double step_down_mm = 1.5, allowance_mm = 0.3;
  double plunge_speed_mm_per_s = 5, ramp_degrees = 5, safe_height_mm = 5, spindle_rpm = 12'000;

  static constexpr auto parameters = std::tuple_cat(
      inherit_parameters<MillOptions>(MachineOptions::parameters),
      std::tuple{
          parameter("x_mm", &MillOptions::x_mm, "Place, x", unit::mm, -20'000, 20'000,
                    "Of the carving's lower left corner on the bed.")
              .group("Placement")
              .slider(0, 1000),
          parameter("y_mm", &MillOptions::y_mm, "Place, y", unit::mm, -20'000, 20'000,
                    "Of the carving's lower left corner on the bed.")
              .group("Placement")
              .slider(0, 1000),
          parameter("width_mm", &MillOptions::width_mm, "Width", unit::mm, 1, 5000,
                    "Of the carving; auto: as the file says.")
              .group("Carving")
              .slider(20, 400),
          parameter("thickness_mm", &MillOptions::thickness_mm, "Depth", unit::mm, 0.01, 500,
                    "Height of white over black, for a height map; models carry their own.")
              .group("Carving")
              .slider(0.5, 20),
          parameter("pixel_mm", &MillOptions::pixel_mm, "Grid", unit::mm, 0.01, 10,
                    "Of the height field a model is turned into; height maps carry their own.")
              .group("Carving")
              .slider(0.05, 1)
              .advanced(),
          parameter("stock_over_mm", &MillOptions::stock_over_mm, "Stock over the top", unit::mm, 0, 500,
                    "How far the stock stands over the carving's highest point; z is 0 on the stock.")
              .group("Carving")
              .slider(0, 5),
          parameter("path_tolerance_mm", &MillOptions::path_tolerance_mm, "Path tolerance", unit::mm, 0.001, 1,
                    "How far a line may pass over the lowest places of the tool, never below them: more of it makes "
                    "fewer, longer lines.")
              .group("Carving")
              .slider(0.002, 0.05)
              .advanced(),
          parameter("stages", &MillOptions::stages, "Stages",
                    "With a tool for each there are two jobs, and z is set to 0 with each tool.")
              .group("Carving"),
          parameter("tool", &MillOptions::tool, "Tool", "That finishes the surface.").group("Finishing"),
          parameter("diameter_mm", &MillOptions::diameter_mm, "Diameter", unit::mm, 0.1, 100,
                    "Of the tool that finishes; of a V at its widest.")
              .group("Finishing")
              .slider(0.5, 12),
          parameter("v_angle_degrees", &MillOptions::v_angle_degrees, "V angle", unit::degrees, 10, 170,
                    "Of a V tool, from side to side.")
              .group("Finishing")
              .slider(15, 120),
          parameter("v_tip_mm", &MillOptions::v_tip_mm, "V tip", unit::mm, 0, 10, "Diameter of a V tool's flat tip.")
              .group("Finishing")
              .slider(0, 1)
              .advanced(),
          parameter("finish_stepover_percent", &MillOptions::finish_stepover_percent, "Stepover", unit::percent, 1, 100,
                    "Between lines, of the diameter; whole steps of the grid are taken.")
              .group("Finishing")
              .slider(5, 50),
          parameter("finish_speed_mm_per_s", &MillOptions::finish_speed_mm_per_s, "Feed", unit::mm_per_s, 0.1, 1000,
                    "Along the surface.")
              .group("Finishing")
              .slider(1, 100),
          parameter("finish_along", &MillOptions::finish_along, "Lines along",
                    "The direction of the lines that finish.")
              .group("Finishing"),
          parameter("rough_tool", &MillOptions::rough_tool, "Tool", "That roughs out.").group("Roughing"),
          parameter("rough_diameter_mm", &MillOptions::rough_diameter_mm, "Diameter", unit::mm, 0.1, 100,
                    "Of the tool that roughs out.")
              .group("Roughing")
              .slider(0.5, 12),
          parameter("rough_stepover_percent", &MillOptions::rough_stepover_percent, "Stepover", unit::percent, 1, 100,
                    "Between lines, of the diameter; whole steps of the grid are taken.")
              .group("Roughing")
              .slider(20, 80),
          parameter("rough_speed_mm_per_s", &MillOptions::rough_speed_mm_per_s, "Feed", unit::mm_per_s, 0.1, 1000,
                    "Along a layer.")
              .group("Roughing")
              .slider(1, 100),
          parameter("step_down_mm", &MillOptions::step_down_mm, "Step down", unit::mm, 0.01, 100, "Depth of a layer.")
              .group("Roughing")
              .slider(0.2, 5),
          parameter("allowance_mm", &MillOptions::allowance_mm, "Allowance", unit::mm, 0, 20, "Left for finishing.")
              .group("Roughing")
              .slider(0, 1),
          parameter("plunge_speed_mm_per_s", &MillOptions::plunge_speed_mm_per_s, "Plunge", unit::mm_per_s, 0.1, 500,
                    "While going down into the material.")
              .group("Feeds")
              .slider(1, 50),
          parameter("ramp_degrees", &MillOptions::ramp_degrees, "Ramp", unit::degrees, 1, 90,
                    "How steeply the tool goes down into the material.")
              .group("Feeds")
              .slider(1, 30)
              .advanced(),
          parameter("safe_height_mm", &MillOptions::safe_height_mm, "Safe height", unit::mm, 0.5, 500,
                    "Of travel over the stock.")
              .group("Feeds")
              .slider(1, 30),
          parameter("spindle_rpm", &MillOptions::spindle_rpm, "Spindle", Unit{"1/min"}, 0, 100'000,
                    "Turns a minute (S).")
              .group("Feeds")
              .slider(1000, 30'000)});
};

}  // namespace formwright
