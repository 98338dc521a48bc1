// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How a laser runs a drawing.
#include "fabrication/toolpath/machine_options.h"
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

  static constexpr auto parameters = std::tuple_cat(
      inherit_parameters<LaserMachineOptions>(MachineOptions::parameters),
      std::tuple{
          parameter("power_max_s", &LaserMachineOptions::power_max_s, "S value of full power", unit::none, 1, 100'000,
                    "The S value that means 100 % power: $30 on GRBL, usually 1000; 255 on Marlin.")
              .group("Machine")
              .slider(255, 1000)
              .advanced(),
          parameter(
              "dynamic_power", &LaserMachineOptions::dynamic_power, "Dynamic power",
              "Reduces the power when the head slows down, as in corners (M4). Off keeps the power constant (M3), which burns corners more.")
              .group("Machine"),
          parameter(
              "air_assist", &LaserMachineOptions::air_assist, "Air assist",
              "Turns on the air pump before the first path (M8) and off after the last one (M9). The air clears smoke and flames from the cut.")
              .group("Machine")});
};

struct LaserOptions : LaserMachineOptions {
  double x_mm = 0, y_mm = 0, turn_degrees = 0;
  bool mirrored = false;
  UserUnit user_unit = UserUnit::as_in_file;
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
          parameter("x_mm", &LaserOptions::x_mm, "Position in x", unit::mm, -20'000, 20'000,
                    "Distance of the drawing's left edge from the left side of the bed.")
              .group("Placement")
              .slider(0, 1000),
          parameter("y_mm", &LaserOptions::y_mm, "Position in y", unit::mm, -20'000, 20'000,
                    "Distance of the drawing's front edge from the front of the bed.")
              .group("Placement")
              .slider(0, 1000),
          parameter("turn_degrees", &LaserOptions::turn_degrees, "Turn", unit::degrees, -360, 360,
                    "Rotates the drawing counter-clockwise, after any mirroring.")
              .group("Placement")
              .slider(-180, 180),
          parameter("mirrored", &LaserOptions::mirrored, "Mirror horizontally",
                    "Swaps left and right in the drawing, for material that is cut from its back.")
              .group("Placement"),
          parameter(
              "user_unit", &LaserOptions::user_unit, "Drawing unit",
              "The unit of the drawing's numbers, if the file does not state its size. Pixels are 96 per inch (Inkscape, browsers), points 72 per inch (Illustrator).")
              .group("Placement")
              .advanced(),
          parameter(
              "take_as", &LaserOptions::take_as, "Assign layers",
              "As drawn decides by the names of groups, then by colour: red is cut, blue is marked, black is engraved. Notes are never sent to the machine. The other choices treat all lines alike.")
              .group("Placement"),
          parameter("cut_enabled", &LaserOptions::cut_enabled, "Cut",
                    "Includes the lines that are cut through in the job.")
              .group("Cut"),
          parameter(
              "cut_power_percent", &LaserOptions::cut_power_percent, "Cutting power", unit::percent, 0, 100,
              "Laser power for cutting through. More cuts thicker material and burns a wider, darker edge; find it with the laser test.")
              .group("Cut"),
          parameter(
              "cut_speed_mm_per_s", &LaserOptions::cut_speed_mm_per_s, "Cutting speed", unit::mm_per_s, 0.1, 2000,
              "Speed of the head for cutting through. Slower cuts thicker material and chars more; find it with the laser test.")
              .group("Cut")
              .slider(1, 100),
          parameter("cut_passes", &LaserOptions::cut_passes, "Cutting passes", unit::none, 1, 100,
                    "How many times every cut is repeated. More passes cut thicker material; 1 is usual.")
              .group("Cut")
              .slider(1, 10),
          parameter(
              "cut_step_down_mm", &LaserOptions::cut_step_down_mm, "Z step per pass", unit::mm, 0, 20,
              "Lowers the head by this much before each further pass, to keep thick material in focus. 0 for machines without a Z axis.")
              .group("Cut")
              .slider(0, 3)
              .advanced(),
          parameter("mark_enabled", &LaserOptions::mark_enabled, "Mark",
                    "Includes the lines that are marked on the surface in the job.")
              .group("Mark"),
          parameter(
              "mark_power_percent", &LaserOptions::mark_power_percent, "Marking power", unit::percent, 0, 100,
              "Laser power for marking lines on the surface. More makes darker, deeper lines; begin with 20 % and find it with the laser test.")
              .group("Mark"),
          parameter("mark_speed_mm_per_s", &LaserOptions::mark_speed_mm_per_s, "Marking speed", unit::mm_per_s, 0.1,
                    2000, "Speed of the head for marking lines on the surface. Slower makes darker, deeper lines.")
              .group("Mark")
              .slider(1, 300),
          parameter("mark_passes", &LaserOptions::mark_passes, "Marking passes", unit::none, 1, 100,
                    "How many times every marked line is repeated. 1 is usual.")
              .group("Mark")
              .slider(1, 10)
              .advanced(),
          parameter("engrave_enabled", &LaserOptions::engrave_enabled, "Engrave",
                    "Includes the areas that are engraved in the job.")
              .group("Engrave"),
          parameter(
              "engrave_power_percent", &LaserOptions::engrave_power_percent, "Engraving power", unit::percent, 0, 100,
              "Laser power for engraving. More makes darker, deeper areas; begin with 25 % and find it with the laser test.")
              .group("Engrave"),
          parameter("engrave_speed_mm_per_s", &LaserOptions::engrave_speed_mm_per_s, "Engraving speed", unit::mm_per_s,
                    0.1, 2000, "Speed of the head for engraving. Slower makes darker, deeper areas.")
              .group("Engrave")
              .slider(1, 500),
          parameter("engrave_passes", &LaserOptions::engrave_passes, "Engraving passes", unit::none, 1, 100,
                    "How many times every engraved line is repeated. More engrave deeper; 1 is usual.")
              .group("Engrave")
              .slider(1, 10)
              .advanced(),
          parameter("engrave_fill", &LaserOptions::engrave_fill, "Fill shapes",
                    "On: closed shapes are filled with parallel lines. Off: only their outlines are engraved.")
              .group("Engrave"),
          parameter(
              "engrave_line_mm", &LaserOptions::engrave_line_mm, "Line spacing", unit::mm, 0.01, 10,
              "Distance between the parallel lines that fill a shape. Closer is darker and takes longer; 0.1 mm is about the width of a laser beam.")
              .group("Engrave")
              .slider(0.05, 1),
          parameter(
              "kerf_mm", &LaserOptions::kerf_mm, "Kerf", unit::mm, 0, 5,
              "Width of material that the beam burns away, about 0.1 mm; measure it with the kerf test. Closed cuts are moved by half of it. 0 follows the lines as drawn.")
              .group("Cutting")
              .slider(0, 0.5),
          parameter(
              "kerf_side", &LaserOptions::kerf_side, "Keep the size of",
              "Which side of each closed cut keeps its drawn size: the part that falls out, the opening that remains, or neither (the beam follows the line).")
              .group("Cutting"),
          parameter(
              "tabs_count", &LaserOptions::tabs_count, "Tabs per part", unit::none, 0, 100,
              "Number of short bridges left uncut in the outline of every part, so that it does not drop or tilt. 0: none.")
              .group("Cutting")
              .slider(0, 12),
          parameter(
              "tab_width_mm", &LaserOptions::tab_width_mm, "Tab width", unit::mm, 0.05, 50,
              "Width of each bridge that remains after cutting. Wider holds better and is harder to break; 0.5 mm is usual.")
              .group("Cutting")
              .slider(0.2, 5),
          parameter(
              "overcut_mm", &LaserOptions::overcut_mm, "Overcut", unit::mm, 0, 20,
              "How far a closed cut continues beyond its starting point, so that the part comes free. 0: stops at the start.")
              .group("Cutting")
              .slider(0, 3),
          parameter(
              "inner_first", &LaserOptions::inner_first, "Inner cuts first",
              "Cuts openings, and everything inside them, before the outline around them, so that no part moves before it is finished.")
              .group("Cutting"),
          parameter("free_start", &LaserOptions::free_start, "Choose starting points",
                    "On: every closed path starts where that shortens travel. Off: it starts at the first point drawn.")
              .group("Cutting")
              .advanced(),
          parameter(
              "join_mm", &LaserOptions::join_mm, "Join ends within", unit::mm, 0, 5,
              "Largest gap between the ends of two lines that are joined to one path. Larger closes sloppy drawings, but may join lines that should stay apart.")
              .group("Cutting")
              .slider(0, 0.5)
              .advanced()});
};

}  // namespace formwright
