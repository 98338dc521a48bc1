// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How a laser runs a drawing.
#include "fabrication/machine_options.h"
#include "fabrication/svg/svg_reader.h"

namespace formwright {

/// Which side of a cut keeps its size.
enum class KerfSide { parts, openings, centre };
template <>
struct EnumNames<KerfSide> {
  static constexpr std::array<std::string_view, 3> names{"parts", "openings", "centre"};
  static constexpr std::array<std::string_view, 3> labels{"The parts keep their size", "The openings keep their size",
                                                          "Cut on the line"};
};

/// On which layer everything is taken to be that is not a note.
enum class TakeAs { as_drawn, cut, mark, engrave };
template <>
struct EnumNames<TakeAs> {
  static constexpr std::array<std::string_view, 4> names{"as_drawn", "cut", "mark", "engrave"};
  static constexpr std::array<std::string_view, 4> labels{"As drawn", "Cut everything", "Mark everything",
                                                          "Engrave everything"};
};

struct LaserMachineOptions : MachineOptions {
  double power_max_s = 1000;
  bool dynamic_power = true;
  bool air_assist = false;

  static constexpr auto parameters =
      std::tuple_cat(inherit_parameters<LaserMachineOptions>(MachineOptions::parameters),
                     std::tuple{parameter("power_max_s", &LaserMachineOptions::power_max_s, "S of full power",
                                          unit::none, 1, 100'000, "GRBL's $30; 255 on Marlin.")
                                    .group("Machine")
                                    .slider(255, 1000)
                                    .advanced(),
                                parameter("dynamic_power", &LaserMachineOptions::dynamic_power, "Dynamic power",
                                          "M4: less power while the head is slower, as in corners. Off: M3, constant.")
                                    .group("Machine"),
                                parameter("air_assist", &LaserMachineOptions::air_assist, "Air assist",
                                          "M8 before the first path, M9 after the last one.")
                                    .group("Machine")});
};

struct LaserOptions : LaserMachineOptions {
  double x_mm = 0, y_mm = 0, turn_degrees = 0;
  bool mirrored = false;
  UserUnit user_unit = UserUnit::as_told;
  TakeAs take_as = TakeAs::as_drawn;

  bool cut_enabled = true, mark_enabled = true, engrave_enabled = true;
  double cut_power_percent = 80, mark_power_percent = 20, engrave_power_percent = 25;
  double cut_speed_mm_per_s = 10, mark_speed_mm_per_s = 50, engrave_speed_mm_per_s = 80;
  int cut_passes = 1, mark_passes = 1, engrave_passes = 1;
  double cut_step_down_mm = 0;
  bool engrave_fill = false;
  double engrave_line_mm = 0.1;

  double kerf_mm = 0.1;
  KerfSide kerf_side = KerfSide::parts;
  int tabs_count = 0;
  double tab_width_mm = 0.5;
  double overcut_mm = 0;
  bool inner_first = true;
  bool free_start = true;
  double join_mm = 0.05;

  static constexpr auto parameters = std::tuple_cat(
      inherit_parameters<LaserOptions>(LaserMachineOptions::parameters),
      std::tuple{
          parameter("x_mm", &LaserOptions::x_mm, "Place, x", unit::mm, -20'000, 20'000,
                    "Of the drawing's lower left corner on the bed.")
              .group("Placement")
              .slider(0, 1000),
          parameter("y_mm", &LaserOptions::y_mm, "Place, y", unit::mm, -20'000, 20'000,
                    "Of the drawing's lower left corner on the bed.")
              .group("Placement")
              .slider(0, 1000),
          parameter("turn_degrees", &LaserOptions::turn_degrees, "Turn", unit::degrees, -360, 360,
                    "Counter-clockwise, after mirroring.")
              .group("Placement")
              .slider(-180, 180),
          parameter("mirrored", &LaserOptions::mirrored, "Mirrored",
                    "Left and right exchanged: for a material that is cut from its back.")
              .group("Placement"),
          parameter("user_unit", &LaserOptions::user_unit, "Unit",
                    "What the drawing's numbers mean, when it does not tell its size.")
              .group("Placement")
              .advanced(),
          parameter(
              "take_as", &LaserOptions::take_as, "Layers",
              "As drawn: by the names of groups, then by colour: red is cut, blue is mark, black is engrave. Notes never reach the machine.")
              .group("Placement"),
          parameter("cut_enabled", &LaserOptions::cut_enabled, "Cut", "Runs the layer.").group("Cut"),
          parameter("cut_power_percent", &LaserOptions::cut_power_percent, "Power", unit::percent, 0, 100,
                    "For cutting through.")
              .group("Cut"),
          parameter("cut_speed_mm_per_s", &LaserOptions::cut_speed_mm_per_s, "Speed", unit::mm_per_s, 0.1, 2000,
                    "For cutting through.")
              .group("Cut")
              .slider(1, 100),
          parameter("cut_passes", &LaserOptions::cut_passes, "Passes", unit::none, 1, 100,
                    "How often every cut is run.")
              .group("Cut")
              .slider(1, 10),
          parameter("cut_step_down_mm", &LaserOptions::cut_step_down_mm, "Lower by", unit::mm, 0, 20,
                    "The head with every further pass; 0 without a z axis.")
              .group("Cut")
              .slider(0, 3)
              .advanced(),
          parameter("mark_enabled", &LaserOptions::mark_enabled, "Mark", "Runs the layer.").group("Mark"),
          parameter("mark_power_percent", &LaserOptions::mark_power_percent, "Power", unit::percent, 0, 100,
                    "For marking the surface.")
              .group("Mark"),
          parameter("mark_speed_mm_per_s", &LaserOptions::mark_speed_mm_per_s, "Speed", unit::mm_per_s, 0.1, 2000,
                    "For marking the surface.")
              .group("Mark")
              .slider(1, 300),
          parameter("mark_passes", &LaserOptions::mark_passes, "Passes", unit::none, 1, 100,
                    "How often every mark is run.")
              .group("Mark")
              .slider(1, 10)
              .advanced(),
          parameter("engrave_enabled", &LaserOptions::engrave_enabled, "Engrave", "Runs the layer.").group("Engrave"),
          parameter("engrave_power_percent", &LaserOptions::engrave_power_percent, "Power", unit::percent, 0, 100,
                    "For engraving.")
              .group("Engrave"),
          parameter("engrave_speed_mm_per_s", &LaserOptions::engrave_speed_mm_per_s, "Speed", unit::mm_per_s, 0.1, 2000,
                    "For engraving.")
              .group("Engrave")
              .slider(1, 500),
          parameter("engrave_passes", &LaserOptions::engrave_passes, "Passes", unit::none, 1, 100,
                    "How often every line is run.")
              .group("Engrave")
              .slider(1, 10)
              .advanced(),
          parameter("engrave_fill", &LaserOptions::engrave_fill, "Fill",
                    "Closed shapes are filled with lines; otherwise their outlines are followed.")
              .group("Engrave"),
          parameter("engrave_line_mm", &LaserOptions::engrave_line_mm, "Line distance", unit::mm, 0.01, 10,
                    "Between the lines of a filling.")
              .group("Engrave")
              .slider(0.05, 1),
          parameter("kerf_mm", &LaserOptions::kerf_mm, "Kerf", unit::mm, 0, 5,
                    "How wide the beam burns; measure it with the kerf test. 0 follows the lines as drawn.")
              .group("Cutting")
              .slider(0, 0.5),
          parameter("kerf_side", &LaserOptions::kerf_side, "Sizes",
                    "Closed cuts are moved by half the kerf, so that these keep their size.")
              .group("Cutting"),
          parameter("tabs_count", &LaserOptions::tabs_count, "Tabs", unit::none, 0, 100,
                    "Bridges left in every part's outline, so that it does not drop or tilt.")
              .group("Cutting")
              .slider(0, 12),
          parameter("tab_width_mm", &LaserOptions::tab_width_mm, "Tab width", unit::mm, 0.05, 50,
                    "What stands of each, the kerf taken off.")
              .group("Cutting")
              .slider(0.2, 5),
          parameter("overcut_mm", &LaserOptions::overcut_mm, "Overcut", unit::mm, 0, 20,
                    "How far a closed cut runs on past its start.")
              .group("Cutting")
              .slider(0, 3),
          parameter("inner_first", &LaserOptions::inner_first, "Inner cuts first",
                    "Openings and what lies in them before what contains them, one part after the other.")
              .group("Cutting"),
          parameter("free_start", &LaserOptions::free_start, "Start anywhere",
                    "Closed paths start where it saves travel; off: at their first point.")
              .group("Cutting")
              .advanced(),
          parameter("join_mm", &LaserOptions::join_mm, "Join ends", unit::mm, 0, 5,
                    "Lines whose ends are this close are one path.")
              .group("Cutting")
              .slider(0, 0.5)
              .advanced()});
};

}  // namespace formwright
