// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/gcode/gcode_words.h"

#include <cmath>

namespace formwright {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

bool strip_gcode(std::string_view line, std::string& out) {
  out.clear();
  bool comment = false;
  for (const char c : line) {
    if (comment) {
      comment = c != ')';
      continue;
    }
    if (c == ';') break;
    if (c == '(') comment = true;
    else if (c == ' ' || c == '\t') continue;
    else if (c >= 'a' && c <= 'z') out += static_cast<char>(c - 'a' + 'A');
    else if (c > ' ' && c < 0x7f && c != '!' && c != '?' && c != '~') out += c;
    else return false;  // real-time commands among them: a job must not pause or reset the machine by accident
  }
  if (comment) return false;
  if (out.size() > 1 && out[0] == 'N' && is_digit(out[1])) out.erase(0, out.find_first_not_of("0123456789", 1));
  if (out == "%") out.clear();
  return true;
}

bool read_gcode_words(std::string_view line, bool bare_letters, std::vector<GcodeWord>& words) {
  words.clear();
  std::size_t i = 0;
  while (i < line.size()) {
    const char letter = line[i++];
    if (letter < 'A' || letter > 'Z') return false;
    // A few dozen characters at most: read by hand, because from_chars knows no leading "+" and strtod knows the
    // locale.
    double sign = 1, value = 0, scale = 1;
    bool digits = false, fraction = false;
    const std::size_t start = i;
    if (i < line.size() && (line[i] == '-' || line[i] == '+')) sign = line[i++] == '-' ? -1 : 1;
    for (; i < line.size() && (line[i] == '.' || is_digit(line[i])); ++i) {
      if (line[i] == '.') {
        if (fraction) return false;
        fraction = true;
        continue;
      }
      digits = true;
      value = 10 * value + (line[i] - '0');
      if (fraction) scale *= 10;
    }
    if (!digits && (!bare_letters || i > start)) return false;
    words.push_back({letter, sign * value / scale, digits});
  }
  return true;
}

int tenths_of(double value) {
  const double tenths = value * 10;
  if (!(tenths >= 0 && tenths < 20'000) || std::abs(tenths - std::round(tenths)) > 1e-6) return -1;
  return static_cast<int>(std::lround(tenths));
}

double dwell_s(std::string_view line) {
  std::vector<GcodeWord> words;
  if (!read_gcode_words(line, false, words)) return 0;
  double seconds = 0;
  bool dwell = false;
  for (const auto& [letter, value, has_number] : words) {
    if (letter == 'G' && value == 4) dwell = true;
    if (letter == 'P') seconds = value;
  }
  return dwell ? seconds : 0;
}

LineEffect effect_of(std::string_view line) {
  std::string stripped;
  std::vector<GcodeWord> words;
  LineEffect effect;
  if (!strip_gcode(line, stripped)) return {true, true};
  if (stripped.starts_with("$H") || stripped.starts_with("$J")) return {true, false};
  if (stripped.starts_with("$")) return {false, false};
  if (!read_gcode_words(stripped, false, words)) return {true, true};
  for (const auto& [letter, value, has_number] : words) {
    if ((letter >= 'X' && letter <= 'Z') || (letter == 'G' && (value == 28 || value == 30))) effect.moves = true;
    if ((letter == 'M' && (value == 3 || value == 4)) || (letter == 'S' && value > 0)) effect.fires = true;
  }
  return effect;
}

}  // namespace formwright
