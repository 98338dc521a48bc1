// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Words on sheets as strokes, so that nothing depends on a font.
#include <string>
#include <vector>

#include "fabrication/sheet/cut_sheet.h"

namespace formwright {

/// Width of words of this height: letters are 4 wide, 6 on, 6 high.
double words_width_mm(const std::string& words, double height_mm);

/// Paths of capitals, digits and - . / +, middle at `centre`, reading along the unit vector `along`. Strokes that
/// follow each other are one path.
std::vector<CutPath> word_paths(const std::string& words, const Vec2& centre, const Vec2& along, double height_mm,
                                CutLayer layer);

}  // namespace formwright
