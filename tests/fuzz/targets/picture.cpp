// SPDX-License-Identifier: GPL-3.0-or-later
// PNG and JPEG that are engraved, printed or laid on a model. Their pixels are limited by number and not by the size of
// the file, which a picture of one colour makes a thousandth of them: two million here.
#include "base/error.h"
#include "fuzz/fuzz_check.h"
#include "imaging/picture/picture_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace formwright;
  try {
    const Image image = read_picture({reinterpret_cast<const std::byte*>(data), size}, "input", "picture", 2'000'000);
    fuzz::check(image.width > 0 && image.height > 0 &&
                image.pixels.size() == static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  } catch (const Error& error) {
    fuzz::check_refusal(error);
  }
  return 0;
}
