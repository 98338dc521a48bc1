// SPDX-License-Identifier: GPL-3.0-or-later
// The words of a line of G-code, and what forbids them (gcode.c gc_execute_line, steps 1 to 3).
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "machines/virtual_grbl/virtual_grbl_words.h"

namespace formwright {
namespace {

constexpr int group_of_g(int tenths) {
  switch (tenths) {
    case 40:
    case 100:
    case 280:
    case 281:
    case 300:
    case 301:
    case 530:
    case 920:
    case 921: return 0;
    case 0:
    case 10:
    case 20:
    case 30:
    case 800: return 1;
    case 170:
    case 180:
    case 190: return 2;
    case 900:
    case 910: return 3;
    case 930:
    case 940: return 4;
    case 200:
    case 210: return 5;
    case 400: return 6;
    case 431:
    case 490: return 7;
    case 540:
    case 550:
    case 560:
    case 570:
    case 580:
    case 590: return 8;
    case 610:
    case 911: return 9;
    default: return -1;
  }
}

/// Does the command use the axis words of its line? Two that do exclude each other before their groups are looked at.
constexpr bool claims_axes(int tenths) {
  switch (tenths) {
    case 0:
    case 10:
    case 20:
    case 30:
    case 100:
    case 280:
    case 300:
    case 431:
    case 490:
    case 920: return true;
    default: return false;
  }
}

// M7 needs a build with ENABLE_M7 ("M" in [OPT:...]), which this one is not.
constexpr int group_of_m(int number) {
  switch (number) {
    case 0:
    case 1:
    case 2:
    case 30: return 10;
    case 3:
    case 4:
    case 5: return 11;
    case 8:
    case 9: return 12;
    default: return -1;
  }
}

/// What a command that the firmware does not know is refused with: 23 where a known number has decimals, or where the
/// number overflows the byte that it is kept in.
constexpr int unknown_command(char letter, int tenths) {
  if (tenths > 2559 || tenths < 0) return 23;
  const int whole = tenths / 10 * 10;
  const bool decimals = tenths != whole && whole != 430 && whole != 900 && whole != 910;
  return decimals && letter == 'G' && group_of_g(whole) >= 0 ? 23 : 20;
}

constexpr double max_line_number = 10'000'000, max_tool_number = 255;  // config.h, gcode.h

}  // namespace

int VirtualGrbl::read_words(const std::string& line, bool jog, Words& words) const {
  unsigned groups = 0, letters = 0;
  bool axes_claimed = false;
  struct Length {
    char letter;
    double value;
  };
  std::vector<Length> lengths;  // their unit may stand behind them
  for (const char* at = line.c_str(); *at != '\0';) {
    const char letter = *at++;
    if (letter < 'A' || letter > 'Z') return 1;
    // By hand where a number ends: strtod would read "0X5" as hexadecimal.
    const std::string digits(at, std::strspn(at, "+-.0123456789"));
    char* rest = nullptr;
    const double value = std::strtod(digits.c_str(), &rest);
    if (rest == digits.c_str() || !std::isfinite(value)) return 2;
    at += rest - digits.c_str();  // a second point or sign is where a letter was expected
    Modes& m = words.modes;
    if (letter == 'G' || letter == 'M') {
      const int tenths = static_cast<int>(std::lround(value * 10)), number = tenths / 10;
      if (letter == 'M' && tenths % 10 != 0) return 23;
      if (letter == 'M' && number == 6 && options_.grblhal) {
        words.tool_change = true;
        continue;
      }
      const int group = letter == 'G' ? group_of_g(tenths) : group_of_m(number);
      if (group < 0) return unknown_command(letter, tenths);
      if (letter == 'G' && claims_axes(tenths)) {
        if (axes_claimed) return 24;
        axes_claimed = true;
      }
      if (groups & (1u << group)) return 21;
      groups |= 1u << group;
      // jog.c: units and distance only.
      if (jog && group != 3 && group != 5 && tenths != 530) return 16;
      if (group == 0) words.non_modal = tenths;
      else if (group == 1) m.motion = number, words.motion_word = number != 80;
      else if (group == 2) m.plane = number;
      else if (group == 3) m.relative = number == 91;
      else if (group == 4) m.inverse_time = number == 93;
      else if (group == 5) m.inches = number == 20;
      else if (group == 7) words.tool_word = true, words.sets_tool = tenths == 431, m.tool_mm = 0;
      else if (group == 8) m.system = number;
      else if (group == 10) m.flow = number == 1 ? 0 : number == 0 ? 1 : number;
      else if (group == 11) m.spindle = number;
      continue;
    }
    const unsigned bit = 1u << (letter - 'A');
    if (letters & bit) return 25;
    letters |= bit;
    if (std::strchr("FNPTS", letter) && value < 0) return 4;
    switch (letter) {
      case 'X':
      case 'Y':
      case 'Z':
      case 'I':
      case 'J':
      case 'K':
      case 'R':
      case 'F': lengths.push_back({letter, value}); break;
      case 'S': m.power = value; break;
      case 'P': words.seconds = words.system = value; break;
      case 'L': words.mode_of_system = value; break;
      case 'N':
        if (value > max_line_number) return 27;
        break;
      case 'T':
        if (value > max_tool_number) return 38;
        break;
      default: return 20;
    }
  }
  for (const auto& [letter, value] : lengths) {
    const double mm = words.modes.inches ? 25.4 * value : value;
    if (letter == 'F') words.feed = mm;
    else if (letter == 'R') words.radius_mm = mm;
    else if (letter >= 'X') words.axes[static_cast<std::size_t>(letter - 'X')] = mm;
    else words.centre[static_cast<std::size_t>(letter - 'I')] = mm;
  }
  words.power_word = (letters & (1u << ('S' - 'A'))) != 0;
  if (words.feed && !jog) words.modes.feed_mm_per_min = *words.feed;
  return 0;
}

VirtualGrbl::Point VirtualGrbl::offset_mm(const Modes& modes) const {
  Point sum = systems_.at(modes.system);
  for (std::size_t k = 0; k < 3; ++k) sum[k] += modes.g92_mm[k] + (k == 2 ? modes.tool_mm : 0);
  return sum;
}

/// Where the line leads, and what forbids it.
int VirtualGrbl::find_target(Words& words) const {
  const int special = words.non_modal;
  const bool uses_axes = special == 100 || special == 280 || special == 300 || special == 920;
  if (words.motion_word && (uses_axes || words.tool_word)) return 24;
  if (special == 40 && !words.seconds) return 28;
  if (special == 100 && !words.moves()) return 26;
  if (special == 100 && !words.system && !words.mode_of_system) return 28;
  if (special == 100 && words.system.value_or(0) > 6) return 29;
  if (special == 100 && words.mode_of_system != 2.0 && words.mode_of_system != 20.0) return 20;
  if (words.sets_tool && (!words.axes[2] || words.axes[0] || words.axes[1])) return 37;
  if (special == 920 && !words.moves()) return 26;
  const Point offset = offset_mm(words.modes);
  words.target_mm = parsed_mm_;
  for (std::size_t k = 0; k < 3; ++k) {
    words.plain_mm[k] = words.axes[k].value_or(0);
    if (!words.axes[k]) continue;
    if (special == 530) words.target_mm[k] = *words.axes[k];
    else words.target_mm[k] = *words.axes[k] + (words.modes.relative ? parsed_mm_[k] : offset[k]);
  }
  const int motion = words.modes.motion;
  const bool turns = motion == 2 || motion == 3;
  const bool centred = words.centre[0] || words.centre[1] || words.centre[2];
  if (uses_axes || words.tool_word || !words.moves()) {
    if (words.motion_word && turns && !words.moves()) return 26;
    return centred || words.radius_mm ? 36 : 0;
  }
  if (motion == 80) return 31;
  if (special == 530 && motion > 1) return 30;
  if (motion > 0 && words.modes.feed_mm_per_min <= 0) return 22;
  if (motion > 0 && words.modes.inverse_time && !words.feed) return 22;
  if (turns ? words.radius_mm && centred : centred || words.radius_mm) return 36;
  return 0;
}

}  // namespace formwright
