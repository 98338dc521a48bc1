// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/data/number_list.h"

#include <fast_float/fast_float.h>

#include <cmath>

namespace formwright {

std::optional<std::vector<double>> read_number_list(std::string_view text) {
  const auto between = [](char c) { return c == ' ' || c == ',' || c == ';'; };
  std::vector<double> numbers;
  for (const char *at = text.data(), *end = at + text.size(); at < end;) {
    if (between(*at)) {
      ++at;
      continue;
    }
    double value = 0;
    const auto [next, error] = fast_float::from_chars(at, end, value);
    if (error != std::errc() || !std::isfinite(value) || (next < end && !between(*next))) return std::nullopt;
    numbers.push_back(value);
    at = next;
  }
  return numbers;
}

}  // namespace formwright
