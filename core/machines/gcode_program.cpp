// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/gcode_program.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "machines/machine_driver.h"

namespace formwright {
namespace {

using machines_detail::refuse;

constexpr double at_origin_mm = 0.1;  // machines stop at whole steps, of coarse ones 0.04 mm

struct Word {
  char letter;
  double value;
};

/// Splits "G1X2.5Y-3" into words; false where a letter has no number.
bool read_words(std::string_view line, std::vector<Word>& words) {
  words.clear();
  std::size_t i = 0;
  while (i < line.size()) {
    const char letter = line[i++];
    if (letter < 'A' || letter > 'Z') return false;
    // A few dozen characters at most: read by hand, because from_chars knows no leading "+" and strtod knows the
    // locale.
    double sign = 1, value = 0, scale = 1;
    bool digits = false, fraction = false;
    if (i < line.size() && (line[i] == '-' || line[i] == '+')) sign = line[i++] == '-' ? -1 : 1;
    for (; i < line.size() && (line[i] == '.' || (line[i] >= '0' && line[i] <= '9')); ++i) {
      if (line[i] == '.') {
        if (fraction) return false;
        fraction = true;
        continue;
      }
      digits = true;
      value = 10 * value + (line[i] - '0');
      if (fraction) scale *= 10;
    }
    if (!digits) return false;
    words.push_back({letter, sign * value / scale});
  }
  return true;
}

/// Adds what an arc reaches beyond its ends: where it crosses the directions of the axes.
void add_arc(GcodeBounds& bounds, const std::array<double, 3>& from, const std::array<double, 3>& to, double cx,
             double cy, bool clockwise) {
  const double radius = std::hypot(from[0] - cx, from[1] - cy);
  double start = std::atan2(from[1] - cy, from[0] - cx), end = std::atan2(to[1] - cy, to[0] - cx);
  if (clockwise) std::swap(start, end);
  while (end <= start + 1e-9) end += 2 * std::numbers::pi;
  for (int quarter = -4; quarter <= 8; ++quarter) {
    const double angle = quarter * std::numbers::pi / 2;
    if (angle > start && angle < end) bounds.add({cx + radius * std::cos(angle), cy + radius * std::sin(angle), to[2]});
  }
}

struct Centre {
  double x, y;
};

/// RS274's radius form: the shorter arc for R > 0.
std::optional<Centre> centre_of_radius(const std::array<double, 3>& from, const std::array<double, 3>& to,
                                       double radius, bool clockwise) {
  const double dx = to[0] - from[0], dy = to[1] - from[1], chord = std::hypot(dx, dy);
  const double squared = radius * radius - chord * chord / 4;
  if (chord == 0 || squared < -1e-6 * radius * radius) return std::nullopt;
  double h = std::sqrt(std::max(squared, 0.0)) / chord;
  if (clockwise == (radius > 0)) h = -h;
  return Centre{(from[0] + to[0]) / 2 - h * dy, (from[1] + to[1]) / 2 + h * dx};
}

/// Lets one line act. `bounds` and `fires` may be null.
void act(const std::vector<Word>& words, GcodeState& s, GcodeBounds* bounds, bool* fires) {
  std::array<std::optional<double>, 3> target, centre;
  std::optional<double> radius;
  bool machine_coordinates = false, no_motion = false, moves = false;
  for (const auto& [letter, value] : words) {
    const int tenths = static_cast<int>(std::lround(value * 10));
    if (letter == 'G') {
      switch (tenths) {
        case 0:
        case 10:
        case 20:
        case 30: s.motion = tenths / 10; break;
        case 800: s.motion = 80; break;
        case 170:
        case 180:
        case 190: s.plane = tenths / 10; break;
        case 200: s.inches = true; break;
        case 210: s.inches = false; break;
        case 530: machine_coordinates = true; break;
        case 540:
        case 550:
        case 560:
        case 570:
        case 580:
        case 590: s.work_system = tenths / 10; break;
        case 900: s.relative = false; break;
        case 910: s.relative = true; break;
        case 40:
        case 100:
        case 280:
        case 281:
        case 300:
        case 301:
        case 920:
        case 921: no_motion = true; break;
        default: break;
      }
    } else if (letter == 'M') {
      if (tenths == 30 || tenths == 40 || tenths == 50) s.spindle = tenths / 10;
      if (tenths == 20 || tenths == 300) s.spindle = 5, s.motion = 1, s.relative = false;
      if (tenths == 70) s.mist = true;
      if (tenths == 80) s.flood = true;
      if (tenths == 90) s.mist = s.flood = false;
    }
  }
  const double unit_mm = s.inches ? 25.4 : 1;
  for (const auto& [letter, value] : words) {
    if (letter >= 'X' && letter <= 'Z') target[static_cast<std::size_t>(letter - 'X')] = value * unit_mm;
    if (letter >= 'I' && letter <= 'K') centre[static_cast<std::size_t>(letter - 'I')] = value * unit_mm;
    if (letter == 'R') radius = value * unit_mm;
    if (letter == 'F') s.feed_mm_per_min = value * unit_mm;
    if (letter == 'S') s.power = value;
  }
  if (fires && s.spindle != 5) *fires = true;
  if (no_motion || s.motion == 80) return;
  const std::array<double, 3> from = s.position_mm;
  const bool arc = (s.motion == 2 || s.motion == 3) && (target[0] || target[1] || centre[0] || centre[1]);
  for (std::size_t axis = 0; axis < 2; ++axis)
    if (!s.moved[axis] && !machine_coordinates && (arc || (s.relative && target[axis]))) s.from_here = true;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!target[axis]) continue;
    moves = true;
    if (machine_coordinates) continue;  // where that is in work coordinates only the machine knows
    s.position_mm[axis] = s.relative ? from[axis] + *target[axis] : *target[axis];
    s.moved[axis] = true;
  }
  if (!bounds || machine_coordinates || (!moves && !arc)) return;
  bounds->add(s.position_mm);
  if (!arc || s.plane != 17) return;
  const bool clockwise = s.motion == 2;
  std::optional<Centre> middle;
  if (radius) middle = centre_of_radius(from, s.position_mm, *radius, clockwise);
  else if (centre[0] || centre[1]) middle = Centre{from[0] + centre[0].value_or(0), from[1] + centre[1].value_or(0)};
  if (middle) add_arc(*bounds, from, s.position_mm, middle->x, middle->y, clockwise);
}

/// Does the line say where the origin is? An extruder's (G92 E0) is none; G10 without L is a printer's retraction.
bool moves_origin(const std::vector<Word>& words) {
  bool offset = false, system = false, axis = false, extruder = false, system_word = false;
  for (const auto& [letter, value] : words) {
    offset = offset || (letter == 'G' && std::floor(value) == 92);
    system = system || (letter == 'G' && value == 10);
    axis = axis || (letter >= 'X' && letter <= 'Z');
    extruder = extruder || letter == 'E';
    system_word = system_word || letter == 'L';
  }
  return (offset && (axis || !extruder)) || (system && system_word);
}

/// Without comments, blanks and line number, letters large. False: a comment does not end, or a character belongs in no
/// line.
bool strip(std::string_view line, std::string& out) {
  out.clear();
  bool comment = false;
  for (const char c : line) {
    if (comment) {
      comment = c != ')';
      continue;
    }
    if (c == ';') break;
    if (c == '(') comment = true;
    else if (c == ' ' || c == '\t' || c == '\r') continue;
    else if (c >= 'a' && c <= 'z') out += static_cast<char>(c - 'a' + 'A');
    else if (c > ' ' && c < 0x7f && c != '!' && c != '?' && c != '~') out += c;
    else return false;  // real-time commands among them: a job must not pause or reset the machine by accident
  }
  if (comment) return false;
  if (out.size() > 1 && out[0] == 'N' && out[1] >= '0' && out[1] <= '9')
    out.erase(0, out.find_first_not_of("0123456789", 1));
  if (out == "%") out.clear();
  return true;
}

}  // namespace

void GcodeBounds::add(const std::array<double, 3>& point_mm) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low_mm[axis] = empty ? point_mm[axis] : std::min(low_mm[axis], point_mm[axis]);
    high_mm[axis] = empty ? point_mm[axis] : std::max(high_mm[axis], point_mm[axis]);
  }
  empty = false;
}

GcodeProgram GcodeProgram::read(ByteView file, std::size_t longest_line) {
  GcodeProgram program;
  const std::string_view text = as_text(file);
  GcodeState state;
  std::string stripped;
  std::vector<Word> words;
  int number = 0;
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    const std::string_view raw = text.substr(start, end - start);
    start = end + 1;
    ++number;
    const auto bad = [&](const std::string& what) { refuse("job", "Line " + std::to_string(number) + " " + what); };
    if (!strip(raw, stripped)) bad("has a character that G-code does not have: choose a G-code file.");
    if (stripped.empty()) continue;
    if (stripped[0] == '$') bad("changes the machine's settings ($): send that by hand, not in a job.");
    if (stripped.size() > longest_line)
      bad("has " + std::to_string(stripped.size()) + " characters, more than the " + std::to_string(longest_line) +
          " the machine takes.");
    if (!read_words(stripped, words))
      bad("is not G-code (\"" + stripped.substr(0, 30) + "\"): every letter needs a number.");
    act(words, state, &program.bounds_, &program.fires_);
    if (program.origin_line_ == 0 && moves_origin(words)) program.origin_line_ = number;
    program.starts_.push_back(program.text_.size());
    program.numbers_.push_back(number);
    program.text_ += stripped;
  }
  if (program.numbers_.empty()) refuse("job", "The job has no G-code in it: choose another file.");
  program.from_here_ = state.from_here;
  program.starts_.push_back(program.text_.size());
  return program;
}

std::string_view GcodeProgram::line(int index) const {
  const auto i = static_cast<std::size_t>(index);
  return std::string_view(text_).substr(starts_[i], starts_[i + 1] - starts_[i]);
}

int GcodeProgram::index_of(int number) const {
  return static_cast<int>(std::lower_bound(numbers_.begin(), numbers_.end(), number) - numbers_.begin());
}

GcodeState GcodeProgram::state_before(int index) const {
  GcodeState state;
  std::vector<Word> words;
  for (int i = 0; i < index; ++i)
    if (read_words(line(i), words)) act(words, state, nullptr, nullptr);
  return state;
}

void require_head_at_origin(const GcodeProgram& program, int index,
                            const std::optional<std::array<double, 3>>& head_mm) {
  if (!program.from_here()) return;
  // Gone on with behind its first moves, it is led back to where these ended.
  if (const GcodeState s = program.state_before(index); s.moved[0] || s.moved[1]) return;
  if (!head_mm || std::hypot((*head_mm)[0], (*head_mm)[1]) > at_origin_mm)
    refuse("start", "The job counts from where the head stands (G91): move to x 0, y 0 first, or set the origin here.");
}

void require_fixed_origin(const GcodeProgram& program) {
  if (program.origin_line() > 0)
    refuse("job", "Line " + std::to_string(program.origin_line()) +
                      " moves the origin (G92 or G10), so that nobody can say where the job goes: take that line out "
                      "and set the origin on the machine.");
}

double dwell_s(std::string_view line) {
  std::vector<Word> words;
  if (!read_words(line, words)) return 0;
  double seconds = 0;
  bool dwell = false;
  for (const auto& [letter, value] : words) {
    if (letter == 'G' && value == 4) dwell = true;
    if (letter == 'P') seconds = value;
  }
  return dwell ? seconds : 0;
}

LineEffect effect_of(std::string_view line) {
  std::string stripped;
  std::vector<Word> words;
  LineEffect effect;
  if (!strip(line, stripped)) return {true, true};
  if (stripped.starts_with("$H") || stripped.starts_with("$J")) return {true, false};
  if (stripped.starts_with("$")) return {false, false};
  if (!read_words(stripped, words)) return {true, true};
  for (const auto& [letter, value] : words) {
    if ((letter >= 'X' && letter <= 'Z') || (letter == 'G' && (value == 28 || value == 30))) effect.moves = true;
    if ((letter == 'M' && (value == 3 || value == 4)) || (letter == 'S' && value > 0)) effect.fires = true;
  }
  return effect;
}

}  // namespace formwright
