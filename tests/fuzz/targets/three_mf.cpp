// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/three_mf/three_mf.h"

#include "fuzz/fuzz_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  formwright::fuzz::read_and_write(data, size, formwright::read_three_mf);
  return 0;
}
