// SPDX-License-Identifier: GPL-3.0-or-later
// JSON of foreign origin: what was read can be copied, compared and written, each of which calls itself once a level.
#include "base/data/json_text.h"
#include "fuzz/fuzz_check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace formwright;
  const Json value = parse_json_text({reinterpret_cast<const char*>(data), size});
  if (value.is_discarded()) return 0;
  const Json copy = value;
  fuzz::check(copy == value);
  const std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  fuzz::check(!parse_json_text(text).is_discarded());
  return 0;
}
