// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/grbl/grbl_machine.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "machines/gcode/gcode_words.h"
#include "machines/grbl/grbl_report.h"

namespace formwright {

void GrblMachine::hear_banner(const std::string& line) {
  const std::size_t space = line.find(' ');
  firmware_ = line.substr(space + 1, line.find(' ', space + 1) - space - 1);
  if (line.starts_with("GrblHAL")) kind_ = GrblFirmware::grblhal;
  if (line.find("FluidNC") != std::string::npos) kind_ = GrblFirmware::fluidnc;
}

void GrblMachine::hear(const std::string& line) {
  if (line.starts_with("$N0=") || line.starts_with("$N1=")) {
    startup_[static_cast<std::size_t>(line[2] - '0')] = line.substr(4);
  } else if (line.starts_with("$")) {
    constexpr std::size_t max_digits = 4;  // what noise sends must not fill the memory
    const std::size_t equals = line.find('=');
    if (equals == std::string::npos || equals < 2 || equals > 1 + max_digits || line[1] < '0' || line[1] > '9') return;
    if (const double value = std::strtod(line.c_str() + equals + 1, nullptr); std::isfinite(value))
      settings_[std::atoi(line.c_str() + 1)] = value;
  }
  if (!line.starts_with("[") || line.size() < 6) return;
  const std::size_t colon = line.find(':');
  if (colon == std::string::npos || line.back() != ']') return;
  const std::string name = line.substr(1, colon - 1), value = line.substr(colon + 1, line.size() - colon - 2);
  const double unit_mm = reports_inches().value_or(false) ? 25.4 : 1;
  if (name == "VER") {
    firmware_ = value.substr(0, value.find(':'));
    if (value.find("FluidNC") != std::string::npos) kind_ = GrblFirmware::fluidnc;
  } else if (name == "FIRMWARE") {
    if (value == "grblHAL") kind_ = GrblFirmware::grblhal;
  }
  if (name == "OPT") hear_options(value);
  else if (name == "GC") hear_modes(value);
  else if (name == "TLO") {
    const auto numbers = numbers_between_commas(value);
    if (!numbers.empty()) tool_mm_ = unit_mm * numbers.back();  // grblHAL tells all three axes
  } else if (name.size() == 3 && name[0] == 'G') {
    const auto numbers = numbers_between_commas(value);
    if (numbers.size() < 2) return;
    const Point mm{unit_mm * numbers[0], unit_mm * numbers[1], numbers.size() > 2 ? unit_mm * numbers[2] : 0};
    if (name == "G92") g92_mm_ = mm;
    else offsets_mm_[std::atoi(name.c_str() + 1)] = mm;
  }
}

void GrblMachine::hear_options(const std::string& options) {
  const std::size_t comma = options.find(',');
  option_letters_ = options.substr(0, comma);
  if (comma == std::string::npos) return;
  const auto numbers = numbers_between_commas(options.substr(comma + 1));
  if (!numbers.empty() && numbers[0] >= 1) planner_blocks_ = static_cast<int>(std::min(numbers[0], 10000.0));
  if (numbers.size() >= 2 && numbers[1] >= 64) buffer_bytes_ = static_cast<int>(std::min(numbers[1], 65536.0));
}

void GrblMachine::hear_modes(const std::string& modes) {
  std::string line = modes;
  std::erase(line, ' ');
  std::vector<GcodeWord> words;
  read_gcode_words(line, true, words);
  for (const auto& [letter, value, has_number] : words) {
    if (letter == 'G' && value >= 54 && value < 60) work_system_ = static_cast<int>(value);
    if (letter == 'G' && (value == 50 || value == 51)) scaled_ = value == 51;
    if (letter == 'M' && value >= 3 && value <= 5) spindle_ = static_cast<int>(value);
  }
}

void GrblMachine::follow(const std::string& line) {
  if (line.starts_with("$")) {
    if (line.starts_with("$N0=") || line.starts_with("$N1=")) hear(line);
    return;
  }
  bool axes = false, offset = false, tool = false;
  std::vector<GcodeWord> words;
  read_gcode_words(line, true, words);
  for (const auto& [letter, value, has_number] : words) {
    axes = axes || (letter >= 'X' && letter <= 'Z');
    if (letter == 'M' && value >= 3 && value <= 5) spindle_ = static_cast<int>(value);
    if (letter != 'G') continue;
    if (value >= 54 && value < 60) work_system_ = static_cast<int>(value);
    if (value == 10) offsets_mm_.clear();  // the next report says them again
    if (value == 50 || value == 51) scaled_ = value == 51;
    if (value == 92) offset = true;
    if (value > 92 && value < 92.3) g92_mm_ = {0, 0, 0};
    if (value >= 43 && value < 44) tool = true;
    if (value == 49) tool_mm_ = 0;
  }
  // How much is not known, only that it is in force.
  if (offset && axes) g92_mm_ = {1, 1, 1};
  if (tool) tool_mm_ = 1;
}

void GrblMachine::reset_parser() {
  work_system_ = 54;
  spindle_ = 5;
  g92_mm_ = {0, 0, 0};
  tool_mm_ = 0;
  scaled_ = false;
}

bool GrblMachine::setting_has_bit(int number, int bit, bool fallback) const {
  const auto found = settings_.find(number);
  return found == settings_.end() ? fallback : (static_cast<long>(found->second) >> bit & 1) != 0;
}

std::array<bool, 3> GrblMachine::homed_axes() const {
  std::array<bool, 3> axes{};
  for (int axis = 0; axis < 3; ++axis)
    for (const int cycle : {44, 45, 46}) axes[static_cast<std::size_t>(axis)] |= setting_has_bit(cycle, axis, false);
  const bool reported = kind_ == GrblFirmware::grblhal && (axes[0] || axes[1] || axes[2]);
  return reported ? axes : std::array<bool, 3>{true, true, true};
}

double GrblMachine::setting(int number, double fallback) const {
  const auto found = settings_.find(number);
  return found == settings_.end() ? fallback : found->second;
}

std::optional<bool> GrblMachine::reports_inches() const {
  if (const auto found = settings_.find(13); found != settings_.end()) return found->second != 0;
  return settings_asked_ ? std::optional(false) : std::nullopt;
}

std::optional<GrblMachine::Point> GrblMachine::offset_mm(int system) const {
  const auto found = offsets_mm_.find(system);
  if (found == offsets_mm_.end()) return std::nullopt;
  Point sum = found->second;
  for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] += g92_mm_[axis] + (axis == 2 ? tool_mm_ : 0);
  return sum;
}

std::string GrblMachine::misplaces() const {
  if (g92_mm_ != Point{0, 0, 0})
    return "An offset by G92 is in force in the machine, so that the job would go elsewhere: send G92.1 first.";
  if (tool_mm_ != 0)
    return "A tool length (G43.1) is in force in the machine, so that the job would go elsewhere: send G49 first.";
  if (scaled_)
    return "A scale (G51) is in force in the machine, so that the job would be of another size: send G50 first.";
  return "";
}

std::string GrblMachine::keeps_beam_on() const {
  if (setting(34, 0) > 0)
    return "The laser's output is not dark when it is off ($34=" + machines_detail::decimal(setting(34, 0)) +
           "): send $34=0 first.";
  if (setting_has_bit(9, 2, false))
    return "Laser mode is taken from the laser's output ($9), so the beam would stay on at every corner and travel: send "
           "$9=1 first.";
  return "";
}

std::string GrblMachine::runs_by_itself() const {
  for (std::size_t i = 0; i < startup_.size(); ++i) {
    if (startup_[i].empty()) continue;
    const LineEffect effect = effect_of(startup_[i]);
    if (!effect.moves && !effect.fires) continue;
    const std::string name = "$N" + std::to_string(i) + "=";
    return "The machine runs \"" + startup_[i] + "\" by itself at every start and behind homing, which moves it or " +
           "turns its beam on: send " + name + " to clear that line first (unlock the machine where it is locked).";
  }
  return "";
}

}  // namespace formwright
