// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/data/json_text.h"

#include <vector>

namespace formwright {

bool json_within_limits(std::string_view text, const JsonLimits& limits) {
  std::vector<int> members{0};  // of each open bracket; the first stands for the text itself
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      else in_string = c != '"';
      continue;
    }
    if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (static_cast<int>(members.size()) > limits.max_depth) return false;
      members.push_back(0);
    } else if (c == ']' || c == '}') {
      if (members.size() == 1) return true;  // not JSON, as the parser will say
      members.pop_back();
    } else if (c == ':' && ++members.back() > limits.max_members) {
      return false;
    }
  }
  return true;
}

}  // namespace formwright
