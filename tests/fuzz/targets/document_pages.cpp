// SPDX-License-Identifier: GPL-3.0-or-later
// PDF, PNG and PWG raster that are to be printed.
#include "base/error.h"
#include "fuzz/fuzz_check.h"
#include "machines/print/document_pages.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace formwright;
  const ByteView bytes(reinterpret_cast<const std::byte*>(data), size);
  try {
    const DocumentPages document = read_document_pages(bytes);
    fuzz::check(!document.pages.empty());
    for (const PageSize& page : document.pages)
      fuzz::check(page.width_mm >= 1 && page.width_mm <= 20'000 && page.height_mm >= 1 && page.height_mm <= 20'000);
    if (document.media_type == "application/pdf") fuzz::check(!mirrored_pdf(bytes).empty());
  } catch (const Error& error) {
    fuzz::check_invalid_input(error);
  }
  return 0;
}
