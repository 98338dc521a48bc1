// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A condition that ends the run, with its input kept as a finding.
#include <cstdint>
#include <cstdlib>

namespace formwright::fuzz {

inline void check(bool good) {
  if (!good) std::abort();
}

}  // namespace formwright::fuzz
