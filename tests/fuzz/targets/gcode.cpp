// SPDX-License-Identifier: GPL-3.0-or-later
// G-code, as both of its controllers take it.
#include "fuzz/fuzz_job_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  formwright::fuzz::load_job("grbl", data, size);
  formwright::fuzz::load_job("marlin", data, size);
  return 0;
}
