// SPDX-License-Identifier: GPL-3.0-or-later
// EGV, the jobs of K40 lasers.
#include "fuzz/fuzz_job_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  formwright::fuzz::load_job("k40", data, size);
  return 0;
}
