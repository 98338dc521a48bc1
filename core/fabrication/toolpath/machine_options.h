// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a machine with a bed can do: the same for lasers and mills. A machine's profile stores values of these names.
#include <string>
#include <vector>

#include "base/data/parameters.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// Where the controller counts from. All of them count in mm; upper_left counts y downwards, the others upwards.
enum class BedOrigin { lower_left, upper_left, centre };
template <>
struct EnumNames<BedOrigin> {
  static constexpr std::array<std::string_view, 3> names{"lower_left", "upper_left", "centre"};
  static constexpr std::array<std::string_view, 3> labels{"Lower left", "Upper left, y down", "Centre"};
};

enum class Controller { grbl, grbl_mill, marlin, k40, ruida };
template <>
struct EnumNames<Controller> {
  static constexpr std::array<std::string_view, 5> names{"grbl", "grbl_mill", "marlin", "k40", "ruida"};
  static constexpr std::array<std::string_view, 5> labels{"GRBL laser", "GRBL mill", "Marlin", "K40 (M2 Nano)",
                                                          "Ruida"};
};

struct MachineOptions {
  double bed_x_mm = 400, bed_y_mm = 400;
  BedOrigin origin = BedOrigin::lower_left;
  Controller controller = Controller::grbl;
  double travel_speed_mm_per_s = 100;
  double acceleration_mm_per_s2 = 500;
  double junction_deviation_mm = 0.01;
  int planner_blocks = 16;
  std::string no_go = "";

  static constexpr auto parameters = std::tuple{
      parameter("bed_x_mm", &MachineOptions::bed_x_mm, "Bed width", unit::mm, 10, 20'000,
                "How far the machine's head can move from left to right.")
          .group("Machine")
          .slider(100, 1500),
      parameter("bed_y_mm", &MachineOptions::bed_y_mm, "Bed depth", unit::mm, 10, 20'000,
                "How far the machine's head can move from front to back.")
          .group("Machine")
          .slider(100, 1500),
      parameter(
          "origin", &MachineOptions::origin, "Origin",
          "Corner of the bed, or its centre, where the controller's coordinates are zero. With upper left, y counts towards the front.")
          .group("Machine"),
      parameter("controller", &MachineOptions::controller, "Controller",
                "Type of the machine's control board, which decides the file format and commands of the job.")
          .group("Machine"),
      parameter("travel_speed_mm_per_s", &MachineOptions::travel_speed_mm_per_s, "Travel speed", unit::mm_per_s, 0.1,
                5000, "Speed of moves between two paths, with the beam or tool off the material.")
          .group("Machine")
          .slider(10, 500),
      parameter("acceleration_mm_per_s2", &MachineOptions::acceleration_mm_per_s2, "Acceleration", Unit{"mm/s²"}, 1,
                100'000, "Acceleration of the head ($120 and $121 on GRBL). Used to estimate the time of the job only.")
          .group("Machine")
          .slider(50, 5000)
          .advanced(),
      parameter(
          "junction_deviation_mm", &MachineOptions::junction_deviation_mm, "Junction deviation", unit::mm, 0.001, 2,
          "How fast the controller takes corners: larger values slow down less ($11 on GRBL). Used to estimate the time of the job only.")
          .group("Machine")
          .slider(0.001, 0.1)
          .advanced(),
      parameter(
          "planner_blocks", &MachineOptions::planner_blocks, "Look-ahead moves", unit::none, 2, 1024,
          "How many moves ahead the controller plans its speed: 16 for GRBL on an Arduino. Used to estimate the time of the job only.")
          .group("Machine")
          .slider(8, 64)
          .advanced(),
      parameter(
          "no_go", &MachineOptions::no_go, "No-go zones",
          "Rectangles of the bed that the head must not enter, such as clamps: x0,y0,x1,y1 in mm from the lower left corner, separated by semicolons. Example: 0,0,40,25; 360,0,400,25.")
          .group("Machine")
          .advanced()};
};

struct BedRectangle {
  double x0_mm, y0_mm, x1_mm, y1_mm;
};

/// Throws Error{invalid_input, "no_go"} when it is not a list of fours, or one has no extent.
std::vector<BedRectangle> read_no_go(const std::string& text);

/// From mm from the bed's lower left corner to the controller's own coordinates.
Vec2 to_controller(const Vec2& bed_mm, const MachineOptions& machine);

/// The controller's zero on the bed: where jobs begin and end.
Vec2 origin_on_bed(const MachineOptions& machine);

}  // namespace formwright
