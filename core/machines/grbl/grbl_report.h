// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// GRBL's real-time status report: "<Hold:0|MPos:1.000,2.000,0.000|FS:600,0|Ov:100,100,100>".
#include <array>
#include <optional>
#include <string_view>

#include "machines/driver/machine_driver.h"

namespace formwright {

struct GrblReport {
  MachinePhase phase = MachinePhase::unknown;
  int detail = 0;  // Hold:0 has come to rest, Hold:1 has not; grblHAL tells the number behind Alarm
  std::optional<std::array<double, 3>> machine_mm, work_mm, offset_mm;  // offset: machine minus work, sent now and then
  std::optional<double> feed_mm_per_min, power;
  std::optional<std::array<int, 3>> overrides;  // feed, rapid, power in percent
  std::optional<int> free_blocks, free_bytes;
  std::optional<bool> spindle_on;  // A:S or A:C; none where the report has neither A nor overrides
  bool tool_change = false;        // grblHAL waits for a person to change the tool (M6), and reads no lines
  std::optional<bool> pendant;     // MPG: a hand-held control has the machine
};

/// None for anything that is not a whole report.
std::optional<GrblReport> read_grbl_report(std::string_view line);

/// Numbers between commas; as many as there are, none where one of them is not a number.
std::vector<double> numbers_between_commas(std::string_view text);

}  // namespace formwright
