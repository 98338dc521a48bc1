// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What the numbers of alarms and errors mean, and what to do. The numbers to 9 and 38 are GRBL 1.1's (grbl
// doc/csv/alarm_codes and error_codes); those behind them differ: grblHAL alarms.h and errors.h, FluidNC Alarm.h and
// Error.h.
#include <map>
#include <optional>
#include <string>

namespace formwright {

enum class GrblFirmware { grbl, grblhal, fluidnc };

struct GrblWords {
  std::string text, fix;
};

GrblWords grbl_alarm(int code, GrblFirmware firmware);
/// One or two sentences.
std::string grbl_error(int code, GrblFirmware firmware);
/// Does the machine hear nothing but a reset behind this alarm, and only once its cause is gone?
bool waits_for_reset(int alarm, GrblFirmware firmware);

template <class Words>
std::optional<Words> word_of(const std::map<int, Words>& words, int code) {
  const auto found = words.find(code);
  return found == words.end() ? std::nullopt : std::optional(found->second);
}

// Their own numbers; none where one means what it means in GRBL, or nothing.
std::optional<GrblWords> grblhal_alarm(int code);
std::optional<GrblWords> fluidnc_alarm(int code);
std::optional<std::string> grblhal_error(int code);
std::optional<std::string> fluidnc_error(int code);

}  // namespace formwright
