// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// G-code as a sender needs it: lines without comments, how far they reach, and the state that a line begins in.
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/bytes.h"
#include "machines/gcode/gcode_motion.h"

namespace formwright {

class GcodeProgram {
 public:
  GcodeProgram() = default;
  /// Reads a whole file. Comments in () and after ; go, as do blanks, empty lines, % and leading N numbers.
  /// `longest_line`: most characters of a line as it is sent, its end not counted. `bare_letters`: Marlin's "G28 X".
  /// Throws Error invalid_input ("job") naming the line: too long, a character no G-code has, a $ command, a word
  /// without a number. Needs memory for the text and a fifth of it.
  static GcodeProgram read(ByteView file, std::size_t longest_line, bool bare_letters = false);

  int line_count() const { return line_count_; }
  std::string_view line(int index) const { return find(index).text; }
  /// The line's number in the file, from 1.
  int number(int index) const { return find(index).number; }
  /// Index of the first line whose number is `number` or more; line_count() past the end.
  int index_of(int number) const;
  /// Index of the last line up to `index` that begins with G0, where a cut begins anew; 0 without one.
  int rapid_before(int index) const;

  /// Of all moves, arcs with their bulges, in work coordinates: of a program that counts `from_here` (or z from where
  /// it stands), as if it began at the origin. Only whole where `unclear()` is empty.
  const GcodeBounds& bounds() const { return reach_.bounds; }
  /// Does the path in x and y depend on where the head stands at the start (G91)?
  bool from_here() const { return from_here_; }
  /// Why nobody can say where the job goes: a sentence that names the first such line and what to do; "" where it is
  /// clear.
  const std::string& unclear() const { return unclear_; }
  /// Is the laser or spindle ever turned on?
  bool fires() const { return reach_.fires; }
  GcodeState state_before(int index) const;
  /// Of the text and its index.
  std::size_t memory_bytes() const;
  bool bare_letters() const { return bare_letters_; }

  /// Calls `visit(line, number)` for the lines from `first` to before `end`, in order.
  template <class Visit>
  void for_each_line(int first, int end, const Visit& visit) const {
    if (first >= end) return;
    Found at = find(first);
    for (int i = first;; at = after(at)) {
      visit(at.text, at.number);
      if (++i >= end) return;
    }
  }

 private:
  // Lines stand in text_ with their ends, empty ones as such, so that numbers need not be kept; one in 16 is indexed.
  struct Block {
    std::size_t start;
    int number;
    bool has_rapid;
  };
  struct Found {
    std::string_view text;
    int number;
    std::size_t end;
  };
  Found line_from(std::size_t start, int number) const;
  Found after(const Found& line) const { return line_from(line.end + 1, line.number + 1); }
  Found find(int index) const;

  std::string text_;
  std::vector<Block> blocks_;
  std::vector<GcodeState> checkpoints_;  // before every 1,000th line
  int line_count_ = 0;
  GcodeReach reach_;
  std::string unclear_;
  bool from_here_ = false, bare_letters_ = false;
};

}  // namespace formwright
