// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// G-code as a sender needs it: lines without comments, how far they reach, and the state that a line begins in.
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/bytes.h"

namespace formwright {

/// Modal state (RS274/NGC) that lines leave behind. Lengths in mm, whatever the units of the line.
struct GcodeState {
  bool inches = false, relative = false;
  int plane = 17, work_system = 54;
  int motion = 0;   // G0, G1, G2, G3; 80: none
  int spindle = 5;  // M3, M4, M5
  std::array<double, 3> position_mm{0, 0, 0};
  std::array<bool, 3> moved{};  // has the program said where this axis goes?
  bool from_here = false;       // did it count x or y from where the head stood, before it had said where that is?
  double feed_mm_per_min = 0;
  double power = 0;  // S
  bool mist = false, flood = false;
};

struct GcodeBounds {
  std::array<double, 3> low_mm{0, 0, 0}, high_mm{0, 0, 0};
  bool empty = true;
  void add(const std::array<double, 3>& point_mm);
};

class GcodeProgram {
 public:
  GcodeProgram() = default;
  /// Reads a whole file. Comments in () and after ; go, as do blanks, empty lines, % and leading N numbers.
  /// `longest_line`: most characters of a line as it is sent, its end not counted.
  /// Throws Error invalid_input ("job") naming the line: too long, a character no G-code has, a $ command, a word
  /// without a number.
  static GcodeProgram read(ByteView file, std::size_t longest_line);

  int line_count() const { return static_cast<int>(numbers_.size()); }
  std::string_view line(int index) const;
  /// The line's number in the file, from 1.
  int number(int index) const { return numbers_[static_cast<std::size_t>(index)]; }
  /// Index of the first line whose number is `number` or more; line_count() past the end.
  int index_of(int number) const;

  /// Of all moves, arcs with their bulges, in work coordinates: of a program that counts `from_here`, as if it began at
  /// the origin.
  const GcodeBounds& bounds() const { return bounds_; }
  /// Does the way in x and y depend on where the head stands at the start (G91)?
  bool from_here() const { return from_here_; }
  /// Number of the first line that says where the origin is (G92, G10 L2, G10 L20), 0 without one: behind it
  /// `bounds()` means nothing to the machine.
  int origin_line() const { return origin_line_; }
  /// Is the laser or spindle ever turned on?
  bool fires() const { return fires_; }
  GcodeState state_before(int index) const;

 private:
  std::string text_;
  std::vector<std::size_t> starts_;
  std::vector<int> numbers_;
  int origin_line_ = 0;
  GcodeBounds bounds_;
  bool fires_ = false, from_here_ = false;
};

/// How far a program reaches that counts from where the head stands is known only when that is the origin. `index`: of
/// the line it starts with; `head_mm`: in work coordinates. Throws Error invalid_input ("start").
void require_head_at_origin(const GcodeProgram& program, int index,
                            const std::optional<std::array<double, 3>>& head_mm);

/// How far a program reaches is known only while its origin stays where it is. Throws Error invalid_input ("job").
void require_fixed_origin(const GcodeProgram& program);

/// Seconds that a G4 in this line waits, 0 without one.
double dwell_s(std::string_view line);

/// Does the line turn a laser or spindle on, or move something?
struct LineEffect {
  bool moves = false, fires = false;
};
LineEffect effect_of(std::string_view line);

}  // namespace formwright
