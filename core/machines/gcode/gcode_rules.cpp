// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/gcode/gcode_rules.h"

#include <algorithm>
#include <cmath>

#include "machines/driver/machine_driver.h"

namespace formwright {
namespace {

using machines_detail::decimal;
using machines_detail::refuse;

constexpr double at_origin_mm = 0.1;                            // machines stop at whole steps, of coarse ones 0.04 mm
constexpr double max_tool = 255, max_line_number = 10'000'000;  // grbl, MAX_TOOL_NUMBER and MAX_LINE_NUMBER

/// Modal groups of GRBL 1.1 (gcode.c, step 2); -1: it answers with error 20. Words that move the origin or go to a
/// machine's own places never come here.
int grbl_group(char letter, int tenths) {
  if (letter == 'M') switch (tenths) {
      case 0:
      case 10:
      case 20:
      case 300: return 14;
      case 30:
      case 40:
      case 50: return 15;
      case 70:
      case 80:
      case 90: return 16;
      default: return -1;
    }
  switch (tenths) {
    case 40: return 0;
    case 0:
    case 10:
    case 20:
    case 30:
    case 800: return 1;
    case 170:
    case 180:
    case 190: return 2;
    case 900:
    case 910: return 3;
    case 911: return 4;
    case 940: return 5;
    case 200:
    case 210: return 6;
    case 400: return 7;
    case 490: return 8;
    case 540: return 12;
    case 610: return 13;
    default: return -1;
  }
}

std::string word_text(const GcodeWord& word) { return word.letter + decimal(word.value); }

/// What a line holds, as GRBL's parser counts it.
struct LineWords {
  unsigned groups = 0, letters = 0;
  bool has(char letter) const { return ((letters >> (letter - 'A')) & 1) != 0; }
  bool has_axis() const { return has('X') || has('Y') || has('Z'); }
  bool has_group(int group) const { return ((groups >> group) & 1) != 0; }
};

/// Error codes are those that GRBL would answer with. "": it takes the words.
std::string grbl_refuses_words(const std::vector<GcodeWord>& words, bool mist, LineWords& line) {
  for (const GcodeWord& word : words) {
    const auto [letter, value, has_number] = word;
    if (letter == 'G' || letter == 'M') {
      const int tenths = tenths_of(value), group = tenths < 0 ? -1 : grbl_group(letter, tenths);
      if (letter == 'M' && tenths == 60)
        return "changes the tool (M6, error 20): make a job for each tool and set z to 0 with each.";
      if (group < 0) return "has " + word_text(word) + ", which the machine does not know (error 20): take it out.";
      if (letter == 'M' && tenths == 70 && !mist)
        return "turns the mist on (M7), which this board does not have (error 20): use M8 or take it out.";
      if (line.has_group(group))
        return "has two commands of one kind, the second " + word_text(word) +
               " (error 21): put it on a line of its own.";
      line.groups |= 1u << group;
      continue;
    }
    if (std::string_view("FIJKLNPRSTXYZ").find(letter) == std::string_view::npos)
      return "has the word " + word_text(word) + ", which the machine does not know (error 20): take it out.";
    if (line.has(letter)) return std::string("has the letter ") + letter + " twice (error 25): take one out.";
    line.letters |= 1u << (letter - 'A');
    if (value < 0 && std::string_view("FNPST").find(letter) != std::string_view::npos)
      return "has " + word_text(word) + ", which must not be negative (error 4): correct it.";
    if (letter == 'T' && value > max_tool) return "names a tool over 255 (error 38): take it out.";
    if (letter == 'N' && value > max_line_number) return "has a line number over 10,000,000 (error 27): take it out.";
  }
  return "";
}

/// `after`: the state that the line leaves.
std::string grbl_refuses(const std::vector<GcodeWord>& words, const GcodeState& after, bool mist) {
  LineWords line;
  if (std::string refused = grbl_refuses_words(words, mist, line); !refused.empty()) return refused;
  const bool dwells = line.has_group(0), explicit_motion = line.has_group(1) && after.motion != 80;
  const bool ends = std::any_of(words.begin(), words.end(), [](const GcodeWord& word) {
    return word.letter == 'M' && (word.value == 2 || word.value == 30);
  });
  if (line.has_group(8) && (explicit_motion || line.has_axis()))
    return "has G49 beside a move (error 24): put it on a line of its own.";
  if (after.motion == 80 && line.has_axis())
    return "names a place while no motion is chosen (G80, error 31): say G0 or G1 in it.";
  if (dwells && !line.has('P')) return "waits (G4) without saying how long (P, error 28): add P and the seconds.";
  bool arc = false;
  // Where a program ends (M2) its motion was that of the line, and is G1 afterwards.
  if ((explicit_motion || line.has_axis()) && after.motion != 0 && !ends) {
    if (after.feed_mm_per_min == 0) return "moves at a feed that nothing has set (F, error 22): add F to it.";
    arc = after.motion != 1;
    if (arc && !line.has_axis()) return "has an arc without an end (X, Y, error 26): name where it ends.";
    const auto axes = axes_of_plane(after.plane);
    if (arc && !line.has("XYZ"[axes[0]]) && !line.has("XYZ"[axes[1]]))
      return "has an arc whose end is not in its plane (error 32): name where it ends, or choose the plane (G17).";
  }
  const bool by_radius = arc && line.has('R');
  for (const char letter : std::string_view("IJKLPR")) {
    const bool used = letter == 'P' ? dwells : letter == 'R' ? by_radius : letter == 'L' ? false : arc && !by_radius;
    if (line.has(letter) && !used)
      return std::string("has the word ") + letter + ", which nothing in it uses (error 36): take it out.";
  }
  return "";
}

/// What Marlin knows that can stand in a laser's or mill's job (MarlinFirmware/Marlin, src/gcode/gcode.cpp). Those that
/// have no effect there (G17, G40, G49, G54, G64, G80, G94, M2, M30 without a file) may stay.
bool marlin_knows(char letter, int tenths) {
  static constexpr std::array g{0, 10, 20, 30, 40, 170, 210, 400, 490, 540, 610, 640, 800, 900, 910, 911, 920, 940};
  static constexpr std::array m{0,   1,   2,   3,   4,   5,   7,   8,   9,   10,  11,  17,  18,  30,
                                31,  42,  73,  75,  76,  77,  78,  82,  83,  84,  85,  104, 105, 106,
                                107, 108, 109, 113, 114, 115, 117, 118, 119, 140, 141, 155, 190, 191,
                                201, 203, 204, 205, 220, 221, 226, 280, 300, 302, 400};
  if (letter == 'G') return std::find(g.begin(), g.end(), tenths) != g.end();
  return letter == 'M' && tenths % 10 == 0 && std::find(m.begin(), m.end(), tenths / 10) != m.end();
}

std::string marlin_refuses(const std::vector<GcodeWord>& words) {
  const GcodeWord& first = words.front();
  if (first.letter == 'T')
    return first.value == 0 ? "" : "changes the tool (T): make a job for each tool and set z to 0 with each.";
  if (first.letter != 'G' && first.letter != 'M')
    return "begins with " + word_text(first) +
           ", and Marlin leaves out lines that name no command: begin it with G0 or G1.";
  const int tenths = tenths_of(first.value);
  if (first.letter == 'G' && tenths == 200)
    return "is in inches (G20), which most Marlin boards do not know and take for mm: post the job in mm (G21).";
  if (first.letter == 'G' && (tenths == 180 || tenths == 190))
    return "turns arcs out of the plane (G18, G19), which most Marlin boards leave out: post them as lines.";
  if (!marlin_knows(first.letter, tenths))
    return "has " + word_text(first) + ", which Formwright does not know of Marlin lasers and mills: take it out.";
  const bool text = first.letter == 'M' && (tenths == 1170 || tenths == 1180);
  for (std::size_t i = 1; i < words.size() && !text; ++i)
    if (words[i].letter == 'G' || words[i].letter == 'M')
      return "has two commands, and Marlin leaves out the second, " + word_text(words[i]) +
             ": put it on a line of its own.";
  return "";
}

}  // namespace

void require_clear_path(const GcodeProgram& program) {
  if (!program.unclear().empty()) refuse("job", program.unclear());
}

void require_runnable(const GcodeProgram& program, const GcodeRules& rules) {
  if (rules.dialect == GcodeDialect::marlin_printer) return;
  require_clear_path(program);
  GcodeState state;
  std::vector<GcodeWord> words;
  program.for_each_line(0, program.line_count(), [&](std::string_view line, int number) {
    read_gcode_words(line, program.bare_letters(), words);
    run_gcode_line(words, state, nullptr);
    const std::string refused =
        rules.dialect == GcodeDialect::grbl ? grbl_refuses(words, state, rules.mist) : marlin_refuses(words);
    if (!refused.empty()) refuse("job", "Line " + std::to_string(number) + " " + refused);
  });
}

void require_head_at_origin(const GcodeProgram& program, int index,
                            const std::optional<std::array<double, 3>>& head_mm) {
  if (!program.from_here()) return;
  // Gone on with behind its first moves, it is led back to where these ended.
  if (const GcodeState s = program.state_before(index); s.moved[0] || s.moved[1]) return;
  if (!head_mm || std::hypot((*head_mm)[0], (*head_mm)[1]) > at_origin_mm)
    refuse("start", "The job counts from where the head stands (G91): move to x 0, y 0 first, or set the origin here.");
}

void require_z_reach(const GcodeBounds& bounds, double travel_mm, std::optional<double> lowest_mm) {
  if (!bounds.named[2]) return;
  const double low = bounds.low_mm[2], high = bounds.high_mm[2];
  if (high - low > travel_mm + 1e-3)
    refuse("job", "The job goes from z " + decimal(low) + " to " + decimal(high) + " mm, the machine reaches " +
                      decimal(travel_mm) + " mm in z: make it shallower, or lower its safe height.");
  if (lowest_mm && (low < *lowest_mm - 1e-3 || high > *lowest_mm + travel_mm + 1e-3))
    refuse("job", "The job would leave the machine's reach in z: from where z is 0 it may go from " +
                      decimal(*lowest_mm) + " to " + decimal(*lowest_mm + travel_mm) + " mm, and goes from " +
                      decimal(low) + " to " + decimal(high) +
                      " mm. Set z to 0 on the stock, or lower the safe height.");
}

}  // namespace formwright
