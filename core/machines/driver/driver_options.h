// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What must be known of a machine before anyone talks to it.
#include <tuple>

#include "base/data/parameters.h"

namespace formwright {

enum class DriverController { grbl, marlin, k40, ruida };
enum class MachineTool { laser, mill, printer };

template <>
struct EnumNames<DriverController> {
  static constexpr std::array<std::string_view, 4> names{"grbl", "marlin", "k40", "ruida"};
  static constexpr std::array<std::string_view, 4> labels{"GRBL", "Marlin", "K40 (M2Nano)", "Ruida"};
};
template <>
struct EnumNames<MachineTool> {
  static constexpr std::array<std::string_view, 3> names{"laser", "mill", "printer"};
  static constexpr std::array<std::string_view, 3> labels{"Laser", "Mill", "3D printer"};
};

struct DriverOptions {
  DriverController controller = DriverController::grbl;
  MachineTool tool = MachineTool::laser;
  int baud = 115200;
  double bed_x_mm = 400, bed_y_mm = 400;
  double focus_power_percent = 2;
  double focus_seconds = 60;

  static constexpr auto parameters = std::tuple{
      parameter("controller", &DriverOptions::controller, "Controller",
                "Type of the machine's control board, which decides the commands it understands."),
      parameter("tool", &DriverOptions::tool, "Tool",
                "What the machine works with: a laser beam, a milling cutter or a printing nozzle."),
      parameter("baud", &DriverOptions::baud, "Line speed", unit::none, 1200, 2000000,
                "Speed of the serial connection in bits per second. 115200 for nearly all machines.")
          .advanced(),
      parameter("bed_x_mm", &DriverOptions::bed_x_mm, "Bed width", unit::mm, 10, 10000,
                "How far the machine's head can move from left to right."),
      parameter("bed_y_mm", &DriverOptions::bed_y_mm, "Bed depth", unit::mm, 10, 10000,
                "How far the machine's head can move from front to back."),
      parameter("focus_power_percent", &DriverOptions::focus_power_percent, "Maximum focus power", unit::percent, 0.1,
                20, "Highest laser power while the spot is shown for focusing. Low enough not to burn; 2 % is usual.")
          .advanced(),
      parameter("focus_seconds", &DriverOptions::focus_seconds, "Longest focus time", unit::seconds, 5, 600,
                "The laser turns off by itself after this time.")
          .advanced()};
};

}  // namespace formwright
