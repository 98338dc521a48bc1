// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The grammars of SVG's path data, transforms and lengths (SVG 1.1, chapters 7 and 8); path data and transforms by way
// of SVG++.
#include <optional>
#include <string_view>

#include "fabrication/curve_flattening.h"

namespace formwright {

/// Draws `data` ("M0 0h10...") into the flattener. False when it is not well formed: what came before the fault has
/// been drawn, as SVG asks.
bool draw_path_data(std::string_view data, CurveFlattener& flattener);

/// "translate(1 2) rotate(30)" as one map; none when it is not well formed.
std::optional<Eigen::Affine2d> read_transform(std::string_view text);

inline constexpr double user_units_per_mm = 96 / 25.4;  // CSS: an inch is 96 px

struct SvgLength {
  double value = 0;  // in user units (px), or per cent
  bool percent = false;
  bool absolute = false;  // mm, cm, in, pt, pc, Q: says how large the thing is
};

/// "12.5mm", "3in", "40", "50%"; em and ex count as 16 and 8 px. None when it is neither.
std::optional<SvgLength> read_length(std::string_view text);

}  // namespace formwright
