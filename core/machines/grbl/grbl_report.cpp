// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/grbl/grbl_report.h"

#include <cmath>
#include <cstdlib>
#include <string>

namespace formwright {
namespace {

std::optional<std::array<double, 3>> point(std::string_view text) {
  const std::vector<double> numbers = numbers_between_commas(text);
  if (numbers.size() < 2) return std::nullopt;
  return std::array<double, 3>{numbers[0], numbers[1], numbers.size() > 2 ? numbers[2] : 0.0};
}

std::optional<MachinePhase> phase_of(std::string_view name, int detail) {
  if (name == "Tool") return MachinePhase::paused;
  if (name == "Idle") return MachinePhase::idle;
  if (name == "Run") return MachinePhase::running;
  if (name == "Jog") return MachinePhase::jogging;
  if (name == "Hold") return detail == 0 ? MachinePhase::paused : MachinePhase::pausing;
  if (name == "Home") return MachinePhase::homing;
  if (name == "Alarm") return MachinePhase::alarm;
  if (name == "Door") return MachinePhase::door;
  if (name == "Check") return MachinePhase::check;
  if (name == "Sleep") return MachinePhase::sleep;
  return std::nullopt;
}

}  // namespace

std::vector<double> numbers_between_commas(std::string_view text) {
  std::vector<double> numbers;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(','), text.size());
    const std::string word(text.substr(0, end));
    char* rest = nullptr;
    const double value = std::strtod(word.c_str(), &rest);
    if (word.empty() || *rest != '\0' || !std::isfinite(value)) return {};
    numbers.push_back(value);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return numbers;
}

std::optional<GrblReport> read_grbl_report(std::string_view line) {
  if (line.size() < 3 || line.front() != '<' || line.back() != '>') return std::nullopt;
  line = line.substr(1, line.size() - 2);
  GrblReport report;
  bool first = true;
  while (!line.empty()) {
    const std::size_t end = std::min(line.find('|'), line.size());
    const std::string_view field = line.substr(0, end);
    line.remove_prefix(std::min(end + 1, line.size()));
    const std::size_t colon = field.find(':');
    const std::string_view name = field.substr(0, colon),
                           value = colon == std::string_view::npos ? "" : field.substr(colon + 1);
    if (first) {
      const std::vector<double> detail = numbers_between_commas(value);
      report.detail = detail.empty() ? 0 : static_cast<int>(detail[0]);
      const auto phase = phase_of(name, report.detail);
      if (!phase) return std::nullopt;
      report.phase = *phase;
      report.tool_change = name == "Tool";
      first = false;
    } else if (name == "MPos") report.machine_mm = point(value);
    else if (name == "WPos") report.work_mm = point(value);
    else if (name == "WCO") report.offset_mm = point(value);
    else if (name == "FS" || name == "F") {
      const std::vector<double> numbers = numbers_between_commas(value);
      if (!numbers.empty()) report.feed_mm_per_min = numbers[0];
      if (numbers.size() > 1) report.power = numbers[1];
    } else if (name == "Ov") {
      const std::vector<double> n = numbers_between_commas(value);
      report.spindle_on = report.spindle_on.value_or(false);
      if (n.size() == 3) report.overrides = {static_cast<int>(n[0]), static_cast<int>(n[1]), static_cast<int>(n[2])};
    } else if (name == "A") {
      report.spindle_on = value.find_first_of("SC") != std::string_view::npos;
    } else if (name == "MPG") {
      report.pendant = value == "1";
    } else if (name == "Bf") {
      const std::vector<double> n = numbers_between_commas(value);
      if (n.size() == 2) report.free_blocks = static_cast<int>(n[0]), report.free_bytes = static_cast<int>(n[1]);
    }
  }
  return report;
}

}  // namespace formwright
