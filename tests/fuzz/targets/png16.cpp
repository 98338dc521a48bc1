// SPDX-License-Identifier: GPL-3.0-or-later
#include "fuzz/fuzz_reader.h"
#include "formats/png/png16.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace formwright;
  try {
    const Grey16Image image = read_png16({reinterpret_cast<const std::byte*>(data), size}, "input", "image", 4'000'000);
    const Grey16Image again = read_png16(write_png16(image), "input");
    fuzz::check(again.levels == image.levels && again.width == image.width);
  } catch (const Error& error) {
    fuzz::check_refusal(error);
  }
  return 0;
}
