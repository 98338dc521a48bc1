// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Words and numbers in text formats. std::from_chars for doubles is missing in WASM's libc++, and strtod reads the
// locale; fast_float (Lemire 2021) is exact, and the quickest.
#include <fast_float/fast_float.h>

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

namespace formwright {

constexpr bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }
constexpr bool is_space(char c) { return is_blank(c) || c == '\n'; }

/// A range of characters that is eaten from its front.
struct TextScan {
  const char* at;
  const char* end;

  explicit TextScan(std::string_view text) : at(text.data()), end(text.data() + text.size()) {}
  TextScan(const char* from, const char* to) : at(from), end(to) {}

  bool done() const { return at == end; }
  std::string_view rest() const { return {at, static_cast<std::size_t>(end - at)}; }

  void skip_blanks() {
    while (at != end && is_blank(*at)) ++at;
  }
  void skip_spaces() {
    while (at != end && is_space(*at)) ++at;
  }

  /// Next word; empty at the end. Words are parted by blanks and line ends.
  std::string_view word() {
    skip_spaces();
    const char* const from = at;
    while (at != end && !is_space(*at)) ++at;
    return {from, static_cast<std::size_t>(at - from)};
  }

  /// A decimal number right here, whatever follows it. "inf" and "nan" are read, for the caller to refuse.
  bool number(double& value) {
    const char* from = at;
    if (from != end && *from == '+') {
      ++from;
      if (from != end && *from == '-') return false;
    }
    const auto result = fast_float::from_chars(from, end, value);
    // Beyond the range of a double, newer versions of fast_float report an error beside the infinity.
    if (result.ec == std::errc::invalid_argument) return false;
    at = result.ptr;
    return true;
  }

  /// A whole number right here, whatever follows it; saturates far outside the range of any index.
  bool integer(std::int64_t& value) {
    const char* from = at;
    const bool negative = from != end && *from == '-';
    if (from != end && (*from == '-' || *from == '+')) ++from;
    if (from == end || *from < '0' || *from > '9') return false;
    std::int64_t total = 0;
    for (; from != end && *from >= '0' && *from <= '9'; ++from)
      if (total < std::numeric_limits<std::int64_t>::max() / 20) total = total * 10 + (*from - '0');
    value = negative ? -total : total;
    at = from;
    return true;
  }
};

/// Without blanks and line ends at both sides.
inline std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

/// ASCII letters only.
inline std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c + 32);
  return lower;
}

inline bool equal_ignoring_case(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
    if (lower(a[i]) != lower(b[i])) return false;
  }
  return true;
}

}  // namespace formwright
