// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How a mill carves a height field.
#include "fabrication/toolpath/machine_options.h"

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
          parameter("x_mm", &MillOptions::x_mm, "Position in x", unit::mm, -20'000, 20'000,
                    "Distance of the carving's left edge from the left side of the bed.")
              .group("Placement")
              .slider(0, 1000),
          parameter("y_mm", &MillOptions::y_mm, "Position in y", unit::mm, -20'000, 20'000,
                    "Distance of the carving's front edge from the front of the bed.")
              .group("Placement")
              .slider(0, 1000),
          parameter("width_mm", &MillOptions::width_mm, "Width", unit::mm, 1, 5000,
                    "Width of the carving. Automatic: the width in the file.")
              .group("Carving")
              .slider(20, 400),
          parameter("thickness_mm", &MillOptions::thickness_mm, "Depth", unit::mm, 0.01, 500,
                    "Height between black and white of a height map. Not used for models, which have their own height.")
              .group("Carving")
              .slider(0.5, 20),
          parameter(
              "pixel_mm", &MillOptions::pixel_mm, "Grid spacing", unit::mm, 0.01, 10,
              "Spacing of the heights computed from a model. Smaller shows finer detail and takes longer. Not used for height maps, which have their own pixels.")
              .group("Carving")
              .slider(0.05, 1)
              .advanced(),
          parameter("stock_over_mm", &MillOptions::stock_over_mm, "Stock above the carving", unit::mm, 0, 500,
                    "Height of the uncut stock above the highest point of the carving. z is 0 on top of the stock.")
              .group("Carving")
              .slider(0, 5),
          parameter(
              "path_tolerance_mm", &MillOptions::path_tolerance_mm, "Path tolerance", unit::mm, 0.001, 1,
              "How far the tool may pass above its ideal path, never below. Larger makes fewer and longer moves and a smaller file; 0.01 mm is usual.")
              .group("Carving")
              .slider(0.002, 0.05)
              .advanced(),
          parameter(
              "stages", &MillOptions::stages, "Stages",
              "Whether the job roughs out, finishes, or does both. If the two tools differ, two jobs are written; set z to 0 again after changing the tool.")
              .group("Carving"),
          parameter(
              "tool", &MillOptions::tool, "Finishing tool",
              "Shape of the tool that finishes the surface. Ball is usual for reliefs; a V-bit reaches into narrow grooves.")
              .group("Finishing"),
          parameter(
              "diameter_mm", &MillOptions::diameter_mm, "Finishing diameter", unit::mm, 0.1, 100,
              "Diameter of the finishing tool. For a V-bit, the widest diameter. Smaller reaches finer detail and takes longer; 3 mm is usual.")
              .group("Finishing")
              .slider(0.5, 12),
          parameter("v_angle_degrees", &MillOptions::v_angle_degrees, "V-bit angle", unit::degrees, 10, 170,
                    "Full angle of a V-bit at its tip, from side to side. Common bits: 30°, 60° and 90°.")
              .group("Finishing")
              .slider(15, 120),
          parameter("v_tip_mm", &MillOptions::v_tip_mm, "V-bit tip", unit::mm, 0, 10,
                    "Diameter of the flat at the tip of a V-bit. 0: perfectly sharp; 0.1 mm is usual.")
              .group("Finishing")
              .slider(0, 1)
              .advanced(),
          parameter(
              "finish_stepover_percent", &MillOptions::finish_stepover_percent, "Finishing stepover", unit::percent, 1,
              100,
              "Distance between finishing lines, in percent of the tool's diameter, rounded to the grid. Less leaves smaller ridges and takes longer; 12 % is usual.")
              .group("Finishing")
              .slider(5, 50),
          parameter("finish_speed_mm_per_s", &MillOptions::finish_speed_mm_per_s, "Finishing feed", unit::mm_per_s, 0.1,
                    1000,
                    "Speed of the tool along the surface while finishing. Slower is smoother and safer for thin tools.")
              .group("Finishing")
              .slider(1, 100),
          parameter("finish_along", &MillOptions::finish_along, "Lines along",
                    "Axis along which the finishing lines run.")
              .group("Finishing"),
          parameter("rough_tool", &MillOptions::rough_tool, "Roughing tool",
                    "Shape of the roughing tool. Flat removes material fastest.")
              .group("Roughing"),
          parameter("rough_diameter_mm", &MillOptions::rough_diameter_mm, "Roughing diameter", unit::mm, 0.1, 100,
                    "Diameter of the roughing tool. For a V-bit, the widest diameter. Typical: 3 to 6 mm.")
              .group("Roughing")
              .slider(0.5, 12),
          parameter(
              "rough_stepover_percent", &MillOptions::rough_stepover_percent, "Roughing stepover", unit::percent, 1,
              100,
              "Distance between roughing lines, in percent of the tool's diameter, rounded to the grid. More is faster and loads the tool more; 45 % is usual.")
              .group("Roughing")
              .slider(20, 80),
          parameter("rough_speed_mm_per_s", &MillOptions::rough_speed_mm_per_s, "Roughing feed", unit::mm_per_s, 0.1,
                    1000, "Speed of the tool while roughing out a layer. Slower loads the tool less.")
              .group("Roughing")
              .slider(1, 100),
          parameter(
              "step_down_mm", &MillOptions::step_down_mm, "Depth per layer", unit::mm, 0.01, 100,
              "Depth that each roughing layer removes. Deeper is faster and loads the tool more; half the tool's diameter is usual.")
              .group("Roughing")
              .slider(0.2, 5),
          parameter("allowance_mm", &MillOptions::allowance_mm, "Finishing allowance", unit::mm, 0, 20,
                    "Thickness of material that roughing leaves for the finishing tool to remove. 0.3 mm is usual.")
              .group("Roughing")
              .slider(0, 1),
          parameter("plunge_speed_mm_per_s", &MillOptions::plunge_speed_mm_per_s, "Plunge feed", unit::mm_per_s, 0.1,
                    500, "Speed of the tool while it moves down into the material. Slower protects the tip.")
              .group("Feeds")
              .slider(1, 50),
          parameter(
              "ramp_degrees", &MillOptions::ramp_degrees, "Ramp angle", unit::degrees, 1, 90,
              "How steeply the tool enters the material. Smaller is gentler and takes longer; 5° is usual, 90° goes straight down.")
              .group("Feeds")
              .slider(1, 30)
              .advanced(),
          parameter("safe_height_mm", &MillOptions::safe_height_mm, "Safe height", unit::mm, 0.5, 500,
                    "Height of rapid moves above the stock. High enough to clear clamps: 5 to 10 mm.")
              .group("Feeds")
              .slider(1, 30),
          parameter("spindle_rpm", &MillOptions::spindle_rpm, "Spindle speed", Unit{"1/min"}, 0, 100'000,
                    "Rotation speed of the spindle, in turns per minute. 12,000 is usual for small cutters in wood.")
              .group("Feeds")
              .slider(1000, 30'000)});
};

}  // namespace formwright
