// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What the words of one line ask of the virtual GRBL.
#include "machines/virtual_grbl/virtual_grbl.h"

namespace formwright {

struct VirtualGrbl::Words {
  Modes modes;        // as they are behind the line
  int non_modal = 0;  // in tenths: 40, 100, 280, 281, 300, 301, 530, 920, 921
  bool motion_word = false, tool_word = false, sets_tool = false, power_word = false, tool_change = false;
  std::array<std::optional<double>, 3> axes, centre;  // mm
  std::optional<double> radius_mm, seconds, system, mode_of_system, feed;
  Point target_mm{}, plain_mm{};  // machine coordinates; the axes' words alone
  bool moves() const { return axes[0] || axes[1] || axes[2]; }
};

}  // namespace formwright
