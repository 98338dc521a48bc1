// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Which layer a shape of somebody's drawing belongs to: by the name of the group it is in, else by its colour.
#include <array>
#include <optional>
#include <string_view>

#include "fabrication/sheet/cut_sheet.h"

namespace formwright {

/// "cut", "Cut 2", "score-lines", "notes": by its first word that names a layer, in any case. None when no word does.
std::optional<CutLayer> layer_by_name(std::string_view name);

/// Red is cut, blue is mark, green is note; black and dark greys are engrave. None for any other colour.
std::optional<CutLayer> layer_by_colour(const std::array<int, 3>& rgb);

}  // namespace formwright
