// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What must be known of a machine before anyone talks to it.
#include <tuple>

#include "base/parameters.h"

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
      parameter("controller", &DriverOptions::controller, "Controller", "What the machine's board understands."),
      parameter("tool", &DriverOptions::tool, "Tool", "What the machine does with its material."),
      parameter("baud", &DriverOptions::baud, "Line speed", unit::none, 1200, 2000000,
                "Bits a second on the serial line; 115200 for nearly all.")
          .advanced(),
      parameter("bed_x_mm", &DriverOptions::bed_x_mm, "Bed, x", unit::mm, 10, 10000,
                "How far the head reaches to the side."),
      parameter("bed_y_mm", &DriverOptions::bed_y_mm, "Bed, y", unit::mm, 10, 10000,
                "How far the head reaches to the back."),
      parameter("focus_power_percent", &DriverOptions::focus_power_percent, "Focus power, at most", unit::percent, 0.1,
                20, "The laser shines with no more than this while its spot is looked at.")
          .advanced(),
      parameter("focus_seconds", &DriverOptions::focus_seconds, "Focus, at most", unit::seconds, 5, 600,
                "The laser goes out by itself after so long.")
          .advanced()};
};

}  // namespace formwright
