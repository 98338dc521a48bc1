// SPDX-License-Identifier: GPL-3.0-or-later
// The virtual GRBL's $ lines: system.c system_execute_line, settings.c settings_store_global_setting.
#include <cstdlib>

#include "machines/virtual_grbl/virtual_grbl.h"

namespace formwright {

int VirtualGrbl::act_on_system_line(const std::string& line) {
  const bool rests = state_ == "Idle" || state_ == "Alarm";
  if (line == "$$") {
    if (state_ == "Run" || state_ == "Hold") return 8;
    report_settings();
    return 0;
  }
  if (line == "$G") {
    report_modes();
    return 0;
  }
  if (line == "$X") {
    if (homing_required()) return 46;
    if (state_ == "Alarm") {
      output_ += "[MSG:Caution: Unlocked]\r\n";
      locked_ = false;
      state_ = "Idle";  // its startup lines are not run
    }
    return 0;
  }
  if (line == "$C") {
    if (state_ == "Check") {
      output_ += "[MSG:Disabled]\r\n";
      state_ = "Idle";
      reset();
      return 0;
    }
    if (state_ != "Idle") return 8;
    state_ = "Check";
    output_ += "[MSG:Enabled]\r\n";
    return 0;
  }
  if (!rests) return 8;
  if (line == "$I") {
    if (options_.grblhal) return report_build(), 0;
    output_ += std::string("[VER:1.1h.20190825:Practice]\r\n[OPT:V") + (options_.origin_low ? "Z" : "") + "," +
               std::to_string(options_.planner_blocks) + "," + std::to_string(options_.rx_bytes) + "]\r\n";
    return 0;
  }
  if (line == "$#") {
    report_offsets();
    return 0;
  }
  if (line == "$N") {
    for (std::size_t i = 0; i < startup_.size(); ++i) output_ += "$N" + std::to_string(i) + "=" + startup_[i] + "\r\n";
    return 0;
  }
  if (line == "$SLP") {
    state_ = "Sleep";
    set_spindle(5, 0);
    beam_ = false;
    output_ += "[MSG:Sleeping]\r\n";
    return 0;
  }
  if (line == "$H") {
    if (settings_[22] == 0) return 5;
    state_ = "Home";
    // limits.c limits_go_home moves without spindle; its modal state stays.
    output_power_ = reported_power_ = 0;
    beam_ = false;
    homes_at_s_ = time_s_ + options_.homing_s;
    then([this] { return state_ != "Home"; });
    then([this] {
      run_startup_lines();
      return true;
    });
    return 0;
  }
  return store_setting(line);
}

int VirtualGrbl::store_setting(const std::string& line) {
  if (line.starts_with("$N0=") || line.starts_with("$N1=")) {
    if (state_ != "Idle") return 8;
    const std::string kept = line.substr(4);
    const auto slot = static_cast<std::size_t>(line[2] - '0');
    // It is executed before it is kept.
    if (const int error = kept.empty() ? 0 : act_on_gcode(kept, false)) return error;
    then([this, kept, slot] {
      startup_[slot] = kept;
      return true;
    });
    then_write_eeprom();
    return 0;
  }
  char* rest = nullptr;
  const long number = std::strtol(line.c_str() + 1, &rest, 10);
  if (rest == line.c_str() + 1 || *rest != '=') return 3;
  const double value = std::strtod(rest + 1, nullptr);
  if (!settings_.contains(static_cast<int>(number))) return 3;
  if (value < 0) return 4;
  settings_[static_cast<int>(number)] = value;
  then_write_eeprom();
  return 0;
}

}  // namespace formwright
