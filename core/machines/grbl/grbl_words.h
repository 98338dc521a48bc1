// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What GRBL's numbers mean, and what to do (GRBL 1.1, doc/csv/alarm_codes and error_codes; grblHAL adds some).
#include <string>

namespace formwright {

struct GrblWords {
  std::string text, fix;
};

GrblWords grbl_alarm(int code);
/// One sentence.
std::string grbl_error(int code);

}  // namespace formwright
