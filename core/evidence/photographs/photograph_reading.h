// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The photographs' marks, sorted into those of the sheet and those of the board, and what is wrong with them.
#include <map>

#include "evidence/photographs/mark_finder.h"
#include "evidence/photographs/photograph_measurement.h"

namespace formwright {

struct ReadPhotograph {
  std::string input, file_name;
  int width = 0, height = 0;
  struct OnBoard {
    int strip, mark;
    SquareCorners corners;
  };
  struct OnSheet {
    int mark;
    SquareCorners corners;
  };
  std::vector<OnBoard> board;
  std::vector<OnSheet> sheet;
  std::vector<int> unclear;  // marks of the sheet that were read but not measured
  int foreign = 0, mirrored_sheet = 0, mirrored_board = 0;
  bool cut_short = false;
};

/// Reads them one by one, so that one is in memory at a time. Photographs given twice are read once, with a note.
/// Throws Error{invalid_input} for what is no picture, for fewer than two photographs, and where the marks are mirrored
/// or of another sheet; Error{cancelled}.
std::vector<ReadPhotograph> read_photographs(std::span<const Photograph> photographs, const MarkSheet& sheet,
                                             std::vector<std::string>& notes, Context& context);

}  // namespace formwright
