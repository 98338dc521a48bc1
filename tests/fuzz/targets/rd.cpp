// SPDX-License-Identifier: GPL-3.0-or-later
// RD, the jobs of Ruida lasers, and how far they reach.
#include <cmath>

#include "fuzz/fuzz_job_file.h"
#include "machines/ruida/ruida_bounds.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace formwright;
  fuzz::load_job("ruida", data, size);
  try {
    const GcodeBounds bounds = ruida_bounds({reinterpret_cast<const std::byte*>(data), size});
    for (std::size_t k = 0; k < 2; ++k)
      fuzz::check(std::isfinite(bounds.low_mm[k]) && bounds.low_mm[k] <= bounds.high_mm[k]);
  } catch (const Error& error) {
    fuzz::check_invalid_input(error);
  }
  return 0;
}
