// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/svg/style/svg_paint.h"

#include <algorithm>

#include "fabrication/svg/style/css_selector.h"
#include "fabrication/svg/style/css_syntax.h"
#include "fabrication/svg/grammar/svg_grammar.h"

namespace formwright {
namespace {

constexpr int max_stops = 16, max_references = 4;

std::string_view stop_colour(const pugi::xml_node& stop) {
  std::string_view colour = stop.attribute("stop-color").value();
  read_css_declarations(stop.attribute("style").value(), [&](const CssDeclaration& declaration) {
    if (declaration.name == "stop-color") colour = declaration.value;
  });
  return colour;
}

/// The one colour of a gradient's stops, which may stand in another gradient.
std::optional<SvgColour> single_colour(pugi::xml_node gradient, const SvgIds& ids) {
  std::optional<SvgColour> colour;
  for (int hop = 0; gradient && hop < max_references; ++hop) {
    int stops = 0;
    for (const pugi::xml_node& stop : gradient.children()) {
      if (svg_local_name(stop) != "stop") continue;
      const auto one = read_colour(stop_colour(stop));
      if (!one || ++stops > max_stops || (colour && colour->rgb != one->rgb)) return std::nullopt;
      colour = one;
    }
    if (stops > 0) return colour;
    std::string_view reference = gradient.attribute("href").value();
    if (reference.empty()) reference = gradient.attribute("xlink:href").value();
    const auto found = reference.starts_with('#') ? ids.find(reference.substr(1)) : ids.end();
    gradient = found == ids.end() ? pugi::xml_node() : found->second;
  }
  return std::nullopt;
}

}  // namespace

std::string_view url_id(std::string_view text) {
  text = without_blanks(text);
  if (text.size() < 5 || !same_word(text.substr(0, 4), "url(")) return {};
  text.remove_prefix(4);
  text = without_blanks(text.substr(0, std::min(text.find(')'), text.size())));
  if (!text.empty() && (text.front() == '"' || text.front() == '\'')) {
    text.remove_prefix(1);
    text = text.substr(0, std::min(text.find_first_of("\"'"), text.size()));
  }
  return text.starts_with('#') ? text.substr(1) : std::string_view();
}

double read_opacity(std::string_view text) {
  const auto value = text.empty() ? std::nullopt : read_length(text);
  if (!value || (!value->unitless && !value->percent())) return 1;
  return std::clamp(value->percent() ? value->value / 100 : value->value, 0.0, 1.0);
}

SvgPaint read_paint(std::string_view text, std::string_view current, double opacity, const SvgIds& ids) {
  SvgPaint paint;
  if (opacity == 0 || text.empty()) return paint;
  if (text.size() > 4 && same_word(text.substr(0, 4), "url(")) {
    if (const auto found = ids.find(url_id(text)); found != ids.end()) {
      paint.painted = true;
      paint.colour = single_colour(found->second, ids);
      paint.server = !paint.colour;
      return paint;
    }
    // What stands behind it is meant for this case.
    const std::size_t close = text.find(')');
    text = close == std::string_view::npos ? std::string_view() : without_blanks(text.substr(close + 1));
    if (text.empty()) return paint;
  }
  // Outside of markers there is no context to take a paint from.
  if (same_word(text, "none") || same_word(text, "context-fill") || same_word(text, "context-stroke")) return paint;
  paint.colour = read_colour(same_word(text, "currentcolor") ? current : text);
  paint.painted = !paint.colour || paint.colour->alpha > 0;
  return paint;
}

}  // namespace formwright
