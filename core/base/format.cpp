// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/format.h"

#include <charconv>
#include <cmath>

namespace formwright {
namespace {

std::string text_of(double value, std::chars_format format, int precision) {
  char text[512];  // the largest double has 309 digits before the point
  return {text, std::to_chars(text, text + sizeof text, value, format, precision).ptr};
}

}  // namespace

std::string with_digits(double value, int digits) {
  const double unit = std::pow(10, digits);
  if (!(std::abs(value) >= unit) || !std::isfinite(value)) return text_of(value, std::chars_format::general, digits);
  // The general format would write 290 with two digits as 2.9e+02.
  const double step = std::pow(10, std::floor(std::log10(std::abs(value))) + 1 - digits);
  return text_of(std::round(value / step) * step, std::chars_format::fixed, 0);
}

std::string with_decimals(double value, int decimals) { return text_of(value, std::chars_format::fixed, decimals); }

std::string with_max_decimals(double value, int decimals) {
  std::string text = with_decimals(value, decimals);
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.ends_with('.')) text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

}  // namespace formwright
