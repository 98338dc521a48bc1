// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Words of G-code: "G1X2.5" is the words G1 and X2.5 (RS274/NGC, section 3.3).
#include <string>
#include <string_view>
#include <vector>

namespace formwright {

struct GcodeWord {
  char letter;
  double value;
  bool has_number = true;  // Marlin takes letters alone: "G28 X", "M4 I"
};

/// The line without comments, blanks and leading line number, letters large; "" where nothing is left. False: a comment
/// does not end, or a character belongs in no line.
bool strip_gcode(std::string_view line, std::string& out);

/// Splits a stripped line into words. False where a letter has no number (unless `bare_letters`) or a number no letter.
bool read_gcode_words(std::string_view line, bool bare_letters, std::vector<GcodeWord>& words);

/// Ten times the number of a G or M word: 281 for G28.1; -1 for a number of more digits.
int tenths_of(double value);

/// Seconds that a G4 in this line waits, 0 without one.
double dwell_s(std::string_view line);

/// Does the line turn a laser or spindle on, or move something?
struct LineEffect {
  bool moves = false, fires = false;
};
LineEffect effect_of(std::string_view line);

}  // namespace formwright
