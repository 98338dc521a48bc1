// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/svg/drawing_layers.h"

#include <algorithm>
#include <cctype>
#include <string>
#include <utility>

namespace formwright {

std::optional<CutLayer> layer_by_name(std::string_view name) {
  constexpr std::pair<std::string_view, CutLayer> words[] = {
      {"cut", CutLayer::cut},          {"cuts", CutLayer::cut},          {"cutting", CutLayer::cut},
      {"outline", CutLayer::cut},      {"mark", CutLayer::mark},         {"marks", CutLayer::mark},
      {"marking", CutLayer::mark},     {"score", CutLayer::mark},        {"scores", CutLayer::mark},
      {"fold", CutLayer::mark},        {"folds", CutLayer::mark},        {"crease", CutLayer::mark},
      {"engrave", CutLayer::engrave},  {"engraving", CutLayer::engrave}, {"etch", CutLayer::engrave},
      {"raster", CutLayer::engrave},   {"note", CutLayer::note},         {"notes", CutLayer::note},
      {"guide", CutLayer::note},       {"guides", CutLayer::note},       {"comment", CutLayer::note},
      {"construction", CutLayer::note}};
  std::string word;
  for (std::size_t i = 0; i <= name.size(); ++i) {
    const bool letter = i < name.size() && std::isalpha(static_cast<unsigned char>(name[i]));
    if (letter) {
      word += static_cast<char>(std::tolower(static_cast<unsigned char>(name[i])));
      continue;
    }
    for (const auto& [known, layer] : words)
      if (word == known) return layer;
    word.clear();
  }
  return std::nullopt;
}

std::optional<CutLayer> layer_by_colour(const std::array<int, 3>& rgb) {
  const auto [r, g, b] = rgb;
  const int high = std::max({r, g, b}), low = std::min({r, g, b});
  if (high - low < 40) return high < 128 ? std::optional(CutLayer::engrave) : std::nullopt;
  // Within 30 degrees of hue of the pure colour: the middle channel is less than halfway up.
  const int middle = r + g + b - high - low;
  if (2 * (middle - low) > high - low) return std::nullopt;
  if (high == r) return CutLayer::cut;
  return high == b ? CutLayer::mark : CutLayer::note;
}

}  // namespace formwright
