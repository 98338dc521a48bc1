// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/grbl_power.h"

namespace formwright {

LaserPower laser_power_of(const GcodeProgram& program) {
  LaserPower power;
  int motion = 0, spindle = 5;
  double now = 0;
  for (int i = 0; i < program.line_count(); ++i) {
    bool dwells = false;
    for_each_gcode_word(program.line(i), [&](char letter, double value) {
      if (letter == 'S') now = value;
      if (letter == 'M' && (value == 3 || value == 4 || value == 5)) spindle = static_cast<int>(value);
      if (letter == 'M' && (value == 2 || value == 30)) spindle = 5, motion = 1;
      if (letter == 'G' && (value == 0 || value == 1 || value == 2 || value == 3)) motion = static_cast<int>(value);
      dwells = dwells || (letter == 'G' && value == 4);
    });
    if (now > power.max_power) power.max_power = now, power.max_power_line = program.number(i);
    power.constant = power.constant || spindle == 3;
    if (dwells && spindle == 3 && motion != 0 && now > 0 && power.rest_line == 0) power.rest_line = program.number(i);
  }
  return power;
}

std::string with_dynamic_power(std::string_view line) {
  std::string sent(line);
  for (std::size_t at = sent.find('M'); at != std::string::npos; at = sent.find('M', at + 1)) {
    std::size_t end = at + 1;
    while (end < sent.size() && (sent[end] < 'A' || sent[end] > 'Z')) ++end;
    for_each_gcode_word(std::string_view(sent).substr(at, end - at), [&](char, double value) {
      if (value == 3) sent[sent.find('3', at)] = '4';
    });
  }
  return sent;
}

}  // namespace formwright
