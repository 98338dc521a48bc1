// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Colours as CSS Color 4 writes them.
#include <array>
#include <optional>
#include <string_view>

namespace formwright {

struct SvgColour {
  std::array<int, 3> rgb{};  // 0 to 255
  double alpha = 1;          // 0: not painted
};

/// "#f00", "#ff0000", both with alpha, rgb(), rgba(), hsl(), hsla(), hwb(), the 148 names and "transparent". None for
/// anything else: "none", "currentColor" and paint servers, and lab(), lch(), oklab(), oklch(), color().
std::optional<SvgColour> read_colour(std::string_view text);

}  // namespace formwright
