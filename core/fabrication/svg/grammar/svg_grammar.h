// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The grammars of SVG's path data, transforms and lengths (SVG 1.1, chapters 7 and 8); SVG++ parses path data.
#include <optional>
#include <string_view>
#include <vector>

#include "fabrication/svg/grammar/curve_flattening.h"

namespace formwright {

/// Draws `data` ("M0 0h10...") into the flattener. False when it is not well formed: what came before the fault has
/// been drawn, as SVG asks.
bool draw_path_data(std::string_view data, CurveFlattener& flattener);

/// "translate(1 2) rotate(30)" as one map; none when it is not well formed.
std::optional<Eigen::Affine2d> read_transform(std::string_view text);

/// Sines and cosines of quarter turns are exact: straight lines stay straight.
Eigen::Matrix2d turn_by(double degrees);

/// Of a skew by this angle.
double slope_of(double degrees);

inline constexpr double user_units_per_mm = 96 / 25.4;  // CSS: an inch is 96 px

struct SvgLength {
  enum class Unit { px, percent, em, root_em };
  double value = 0;
  Unit unit = Unit::px;   // px: user units
  bool absolute = false;  // mm, cm, in, pt, pc, Q: says how large the thing is
  bool unitless = false;  // a bare number

  bool percent() const { return unit == Unit::percent; }
};

/// What relative lengths are of, in user units.
struct LengthBase {
  double whole = 0, font_size = 16;
  double of(const SvgLength& length) const;
};

/// "12.5mm", "3in", "40", "50%", "2em"; ex and ch count as half an em. None when it is none of these.
std::optional<SvgLength> read_length(std::string_view text);

/// Lengths with blanks or commas between them; none when one of them is none or there are over 10,000.
std::optional<std::vector<SvgLength>> read_lengths(std::string_view text);

inline constexpr std::string_view blanks = " \t\r\n\f";
/// Without the blanks at its ends.
std::string_view without_blanks(std::string_view text);

/// The word that `text` begins with, ended by a blank, a comma or a slash, which are taken off with it; empty at the
/// end.
std::string_view take_word(std::string_view& text);

/// Is it the same but for the case of its letters?
bool same_word(std::string_view text, std::string_view lower_case);

}  // namespace formwright
