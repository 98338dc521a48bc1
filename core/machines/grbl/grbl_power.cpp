// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/grbl/grbl_power.h"

#include <vector>

namespace formwright {

LaserPower laser_power_of(const GcodeProgram& program) {
  LaserPower power;
  int motion = 0, spindle = 5;
  double now = 0;
  std::vector<GcodeWord> words;
  program.for_each_line(0, program.line_count(), [&](std::string_view line, int number) {
    bool dwells = false;
    read_gcode_words(line, true, words);
    for (const auto& [letter, value, has_number] : words) {
      if (letter == 'S') now = value;
      if (letter == 'M' && (value == 3 || value == 4 || value == 5)) spindle = static_cast<int>(value);
      if (letter == 'M' && (value == 2 || value == 30)) spindle = 5, motion = 1;
      if (letter == 'G' && (value == 0 || value == 1 || value == 2 || value == 3)) motion = static_cast<int>(value);
      dwells = dwells || (letter == 'G' && value == 4);
    }
    if (now > power.max_power) power.max_power = now, power.max_power_line = number;
    power.constant = power.constant || spindle == 3;
    if (dwells && spindle == 3 && motion != 0 && now > 0 && power.rest_line == 0) power.rest_line = number;
  });
  return power;
}

std::array<bool, 2> unplaced_at_first_cut(const GcodeProgram& program) {
  std::array<bool, 2> placed{};
  int motion = 0;
  std::vector<GcodeWord> words;
  for (int i = 0; i < program.line_count(); ++i) {
    std::array<bool, 2> named{};
    bool moves = false, elsewhere = false;
    read_gcode_words(program.line(i), true, words);
    for (const auto& [letter, value, has_number] : words) {
      if (letter == 'G' && (value == 0 || value == 1 || value == 2 || value == 3)) motion = static_cast<int>(value);
      elsewhere =
          elsewhere || (letter == 'G' && (value == 4 || value == 10 || value == 91 || (value >= 28 && value < 31) ||
                                          value == 53 || (value >= 92 && value < 93)));
      if (letter == 'X') named[0] = true;
      if (letter == 'Y') named[1] = true;
      moves = moves || (letter >= 'X' && letter <= 'Z') || letter == 'I' || letter == 'J';
    }
    if (elsewhere) continue;
    if (motion != 0 && moves) {
      const std::array<bool, 3> ever = program.state_before(program.line_count()).moved;
      return {ever[0] && !placed[0], ever[1] && !placed[1]};
    }
    for (std::size_t axis = 0; axis < 2; ++axis) placed[axis] = placed[axis] || named[axis];
  }
  return {};
}

int first_mist_line(const GcodeProgram& program) {
  int found = 0;
  std::vector<GcodeWord> words;
  program.for_each_line(0, program.line_count(), [&](std::string_view line, int number) {
    if (found > 0 || line.find("M7") == std::string_view::npos) return;
    read_gcode_words(line, true, words);
    for (const auto& [letter, value, has_number] : words)
      if (letter == 'M' && value == 7) found = number;
  });
  return found;
}

std::string with_dynamic_power(std::string_view line) {
  std::string sent(line);
  for (std::size_t at = sent.find('M'); at != std::string::npos; at = sent.find('M', at + 1)) {
    std::size_t end = at + 1;
    while (end < sent.size() && (sent[end] < 'A' || sent[end] > 'Z')) ++end;
    std::vector<GcodeWord> word;
    read_gcode_words(std::string_view(sent).substr(at, end - at), true, word);
    if (word.size() == 1 && word[0].value == 3) sent[sent.find('3', at)] = '4';
  }
  return sent;
}

}  // namespace formwright
