// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/marlin/marlin_laser.h"

namespace formwright {
namespace {

/// Is the line this command, "M3" and not "M30"? Marlin takes one command of a line, its first.
bool is_laser_command(std::string_view line, std::string_view name) {
  return line.starts_with(name) && (line.size() == name.size() || line[name.size()] < '0' || line[name.size()] > '9');
}

bool has(std::string_view line, char letter) { return line.find(letter) != std::string_view::npos; }

bool is_inline(MarlinPower power) { return power == MarlinPower::continuous || power == MarlinPower::dynamic; }

bool is_new(const std::string& firmware) {
  const auto version = marlin_version(firmware);
  return version && *version >= std::pair{2, 1};
}

}  // namespace

MarlinPower marlin_power_after(std::string_view line, MarlinPower before) {
  const bool with_i = has(line, 'I');
  if (is_laser_command(line, "M3") || is_laser_command(line, "M4")) {
    if (with_i) return line[1] == '4' ? MarlinPower::dynamic : MarlinPower::continuous;
    return is_inline(before) ? before : MarlinPower::standard;
  }
  if (is_laser_command(line, "M5") && (with_i || !is_inline(before))) return MarlinPower::off;
  return before;
}

MarlinPower marlin_power_before(const GcodeProgram& program, int index) {
  MarlinPower power = MarlinPower::off;
  program.for_each_line(0, index, [&](std::string_view line, int) { power = marlin_power_after(line, power); });
  return power;
}

MarlinLaserUse marlin_laser_use(const GcodeProgram& program) {
  MarlinLaserUse use;
  MarlinPower power = MarlinPower::off;
  program.for_each_line(0, program.line_count(), [&](std::string_view line, int) {
    power = marlin_power_after(line, power);
    use.standard = use.standard || power == MarlinPower::standard;
    use.continuous = use.continuous || power == MarlinPower::continuous;
    use.dynamic = use.dynamic || power == MarlinPower::dynamic;
    use.fan = use.fan || is_laser_command(line, "M106");
  });
  return use;
}

bool marlin_may_light(std::string_view line) {
  if (is_laser_command(line, "M3") || is_laser_command(line, "M4") || is_laser_command(line, "M106")) return true;
  return line.starts_with("G") && has(line, 'S');
}

std::string marlin_line_as_sent(std::string_view line) {
  const bool turns_on = is_laser_command(line, "M3") || is_laser_command(line, "M4");
  if (!turns_on || !has(line, 'I') || has(line, 'S') || has(line, 'O')) return std::string(line);
  return std::string(line.substr(0, 2)) + " I S0";
}

std::optional<std::pair<int, int>> marlin_version(std::string_view firmware) {
  if (firmware.find("Marlin") == std::string_view::npos) return std::nullopt;
  // The first "digit.digit": vendors put words of their own around it.
  for (std::size_t i = 1; i + 1 < firmware.size(); ++i) {
    const auto digit = [&](std::size_t at) { return firmware[at] >= '0' && firmware[at] <= '9'; };
    if (firmware[i] == '.' && digit(i - 1) && digit(i + 1) && (i < 2 || !digit(i - 2)))
      return std::pair{firmware[i - 1] - '0', firmware[i + 1] - '0'};
  }
  return std::nullopt;
}

std::string marlin_when_connection_ends(MachineTool tool, const MarlinLaserUse& use, const std::string& firmware) {
  if (tool == MachineTool::printer)
    return "The printer finishes the moves that it has and stands still; its heaters stay on until somebody turns them "
           "off.";
  const std::string finishes = "The machine finishes the moves that it has, twenty at most. ";
  if (tool == MachineTool::mill && use.standard)
    return finishes + "Its spindle then keeps turning where the tool stands, until somebody switches it off.";
  if (use.standard || use.continuous || use.fan)
    return finishes +
           "The laser then stays on where the head stands, until somebody switches it off. Marlin 2.1 turns it off after "
           "a second if it was built with LASER_SAFETY_TIMEOUT_MS, which cannot be seen from here.";
  if (use.dynamic && is_new(firmware)) return finishes + "The laser is then off (M4 I).";
  if (use.dynamic)
    return finishes +
           "From Marlin 2.1 on, the laser is then off (M4 I). This firmware does not report its version, so stay beside the machine.";
  return finishes + "The job turns nothing on.";
}

Json marlin_warnings(const MarlinLaserUse& use, const std::string& firmware, bool m5_unknown) {
  Json warnings = Json::array();
  if (m5_unknown)
    warnings.push_back(
        "The firmware does not know M5, so nothing here can turn the laser off: build it with LASER_FEATURE, and keep "
        "the machine's own switch at hand.");
  if (use.standard)
    warnings.push_back(
        "The job turns the laser on with M3 or M4 without I: between these lines and M5 it shines on travels and at "
        "rest, too. Make the job for Marlin with dynamic power (M4 I).");
  if (use.continuous)
    warnings.push_back(
        "The job uses constant power (M3 I): where the machine runs out of moves the laser stays on at rest. Make the "
        "job with dynamic power (M4 I).");
  if (use.fan)
    warnings.push_back(
        "The job switches a laser on the fan output (M106). It stays on while the head stands still, and the machine does not report its state: stay beside it.");
  if ((use.continuous || use.dynamic) && !is_new(firmware))
    warnings.push_back(
        "The job switches the laser with its moves (M3 I or M4 I), which Marlin does from version 2.1 on; " +
        (firmware.empty() ? std::string("this firmware does not report its version")
                          : "this firmware calls itself " + firmware) +
        ": others may burn nothing.");
  return warnings;
}

}  // namespace formwright
