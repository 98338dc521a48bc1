// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/grbl/grbl_stream.h"

#include "machines/gcode/gcode_words.h"

namespace formwright {

bool GrblStream::waits_for_motion() const {
  return std::any_of(unanswered_.begin(), unanswered_.end(), [](const Line& line) { return moves_head(line.text); });
}

bool moves_head(const std::string& line) {
  return effect_of(line).moves && !line.starts_with("G10") && !line.starts_with("G92");
}

bool writes_eeprom(const std::string& line) {
  // $J= is a jog, $H homes, $X unlocks; every other $ command reads or writes settings.
  if (line.starts_with("$")) return !line.starts_with("$J");
  // G10 and G28.1, G30.1 write; G54 to G59, G28 and G30 read, which stops the line as well.
  for (std::size_t at = line.find('G'); at != std::string::npos; at = line.find('G', at + 1)) {
    const std::string rest = line.substr(at + 1, 4);
    const auto is = [&](const char* number) {
      const std::string n = number;
      return rest.starts_with(n) && (rest.size() == n.size() || rest[n.size()] < '0' || rest[n.size()] > '9');
    };
    for (const char* number : {"10", "28", "30", "54", "55", "56", "57", "58", "59"})
      if (is(number)) return true;
  }
  return false;
}

}  // namespace formwright
