// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A condition that ends the run, with its input kept as a finding.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "base/error.h"

namespace formwright::fuzz {

inline void check(bool good) {
  if (!good) std::abort();
}

/// One sentence that blames the input.
inline void check_invalid_input(const Error& error) {
  check(error.code() == ErrorCode::invalid_input && std::string_view(error.what()).ends_with('.'));
}
/// The same, of a file that was called "input".
inline void check_refusal(const Error& error) {
  check_invalid_input(error);
  check(std::string_view(error.what()).starts_with("input"));
}

}  // namespace formwright::fuzz
