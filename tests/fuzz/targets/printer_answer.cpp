// SPDX-License-Identifier: GPL-3.0-or-later
// What a printer may answer to Get-Printer-Attributes: IPP as it comes off the network, then what is read from it.
#include <cups/cups.h>

#include <algorithm>
#include <cstring>

#include "fuzz/fuzz_check.h"
#include "system/host.h"
#include "machines/print/printer.h"

namespace {

ssize_t take(void* rest, ipp_uchar_t* to, std::size_t size) {
  auto& bytes = *static_cast<formwright::ByteView*>(rest);
  const std::size_t part = std::min(size, bytes.size());
  if (part > 0) std::memcpy(to, bytes.data(), part);
  bytes = bytes.subspan(part);
  return static_cast<ssize_t>(part);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace formwright;
  ByteView bytes(reinterpret_cast<const std::byte*>(data), size);
  const IppMessage message(ippNew(), ippDelete);
  // What was read before a mistake is kept by libcups, so it is looked at as well.
  ippReadIO(&bytes, take, 1, nullptr, message.get());
  const PrinterDescription printer = read_printer_description(message.get());
  fuzz::check(printer.max_copies >= 1 && printer.max_copies <= 9999);
  for (const PrintMedia& media : printer.media) {
    fuzz::check(media.width_hmm > 0 && media.height_hmm > 0);
    fuzz::check(media.left_hmm >= 0 && media.right_hmm >= 0 && media.top_hmm >= 0 && media.bottom_hmm >= 0);
    fuzz::check(!media.label.empty());
    // Whatever it is called, it is found under its name, or under another of that name and as large.
    fuzz::check(find_print_media(printer.media, media.label) != nullptr);
    fuzz::check(page_matches(media, {media.width_mm(), media.height_mm()}));
  }
  const std::string text = json_text(printer_json(printer));
  fuzz::check(Json::parse(text).is_object());
  return 0;
}
