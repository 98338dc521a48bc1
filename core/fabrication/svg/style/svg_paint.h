// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Whether a shape is painted, and in which colour.
#include <optional>
#include <string_view>
#include <unordered_map>

#include <pugixml.hpp>

#include "fabrication/svg/style/svg_colour.h"

namespace formwright {

using SvgIds = std::unordered_map<std::string_view, pugi::xml_node>;

/// The id in "url(#id) ..."; "" when it is none of this document.
std::string_view url_id(std::string_view text);

/// 0 to 1 from "0.5" or "50%"; 1 when it is neither.
double read_opacity(std::string_view text);

struct SvgPaint {
  bool painted = false;
  bool server = false;              // a gradient or pattern of several colours
  std::optional<SvgColour> colour;  // none of a server, and of one that is not understood
};

/// `current` is what currentColor stands for. A gradient whose stops have one colour is that colour, as Inkscape's
/// swatches are.
SvgPaint read_paint(std::string_view text, std::string_view current, double opacity, const SvgIds& ids);

}  // namespace formwright
