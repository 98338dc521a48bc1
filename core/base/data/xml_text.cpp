// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/data/xml_text.h"

namespace formwright {
namespace {

std::string escaped(std::string_view text, bool with_quotes) {
  std::string result;
  for (const char c : text) {
    if (c == '&') result += "&amp;";
    else if (c == '<') result += "&lt;";
    else if (c == '>') result += "&gt;";
    else if (c == '"' && with_quotes) result += "&quot;";
    else result += c;
  }
  return result;
}

}  // namespace

std::string xml_text(std::string_view text) { return escaped(text, false); }
std::string xml_attribute(std::string_view text) { return escaped(text, true); }

}  // namespace formwright
