// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "base/error.h"

namespace formwright {

/// What was asked for cannot be done as it was asked.
[[noreturn]] inline void refuse(const std::string& where, const std::string& sentence) {
  throw Error(ErrorCode::invalid_input, where, sentence);
}

/// The machine or printer did not do what was asked for.
[[noreturn]] inline void fail_at_machine(const std::string& sentence) {
  throw Error(ErrorCode::could_not_solve, "machine", sentence);
}

}  // namespace formwright
