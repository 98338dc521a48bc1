// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// JSON of foreign origin. Copying, comparing and writing a nlohmann value call themselves once a level, so a text of
// "[[[[..." would end the process by its stack; an ordered object looks every new name up among those before it.
#include <string_view>

#include "base/data/json.h"

namespace formwright {

struct JsonLimits {
  int max_depth = 64;      // arrays and objects within one another
  int max_members = 4096;  // names in one object
};

/// One pass over the text without reading it as JSON: strings are skipped, brackets and colons counted.
bool json_within_limits(std::string_view text, const JsonLimits& limits = {});

/// The value, or a discarded one (`is_discarded()`, no object, array or number) where the text is not JSON or exceeds
/// the limits.
template <class Value = Json>
Value parse_json_text(std::string_view text, const JsonLimits& limits = {}) {
  if (!json_within_limits(text, limits)) return Value(Value::value_t::discarded);
  return Value::parse(text, nullptr, false);
}

}  // namespace formwright
