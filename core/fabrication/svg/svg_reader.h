// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Anybody's SVG as a drawing to cut, at its true size.
#include <string>
#include <vector>

#include "base/bytes.h"
#include "base/context.h"
#include "base/data/parameters.h"
#include "fabrication/sheet/cut_sheet.h"

namespace formwright {

/// What a drawing without physical size is measured in.
enum class UserUnit { as_in_file, px, mm, pt, inch };
template <>
struct EnumNames<UserUnit> {
  static constexpr std::array<std::string_view, 5> names{"as_in_file", "px", "mm", "pt", "inch"};
  static constexpr std::array<std::string_view, 5> labels{"As in the file", "Pixels, 96 an inch", "Millimetres",
                                                          "Points, 72 an inch", "Inches"};
  static constexpr std::array<std::pair<std::string_view, UserUnit>, 1> old_names{{{"as_told", UserUnit::as_in_file}}};
};

struct SvgReadOptions {
  double flatness_mm = 0.01;  // polylines keep this close to their curves
  UserUnit user_unit =
      UserUnit::as_in_file;  // anything else overrides width, height and viewBox: one user unit is one of these
};

struct SvgDrawing {
  CutSheet sheet;                  // names of paths are the elements' ids
  std::vector<std::string> notes;  // what was left out or guessed, in sentences
};

/// Lines as a browser draws them: what is painted, dashed and clipped as it says; what is left out is in the notes. A
/// path's layer: the innermost group around it whose label or id names one (layer_by_name), else the colour of its
/// stroke, of its fill without a stroke (layer_by_colour), else note. The kerf of our own files (kerf_attribute) is
/// known again, also after another program has saved them. Takes at most 200 times the file's size and 64 MB. Throws
/// Error{invalid_input, "drawing"}: not an SVG, no physical size ("user_unit" says it), nothing drawn, words only, over
/// 4 million points, over 20 m, too much to read (DrawingLimits); cancelled.
SvgDrawing read_svg_drawing(ByteView bytes, const SvgReadOptions& options, const Context& context);

}  // namespace formwright
