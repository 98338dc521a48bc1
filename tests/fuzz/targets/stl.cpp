// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/stl/stl.h"

#include "fuzz/fuzz_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  formwright::fuzz::read_and_write(data, size, formwright::read_stl);
  return 0;
}
