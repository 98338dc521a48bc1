// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/svg/svg_shapes.h"

#include <algorithm>
#include <string>

#include "fabrication/svg/grammar/svg_grammar.h"

namespace formwright {
namespace {

void draw_rectangle(CurveFlattener& to, const Vec2& corner, const Vec2& size, double rx, double ry) {
  if (size.x() <= 0 || size.y() <= 0) return;
  if (rx < 0) rx = ry;
  if (ry < 0) ry = rx;
  rx = std::clamp(rx, 0.0, size.x() / 2);
  ry = std::clamp(ry, 0.0, size.y() / 2);
  if (rx == 0 || ry == 0) rx = ry = 0;
  const Vec2 far = corner + size;
  to.move_to({corner.x() + rx, corner.y()});
  const auto round = [&](const Vec2& p) {
    if (rx > 0) to.arc_to(rx, ry, 0, false, true, p);
  };
  to.line_to({far.x() - rx, corner.y()});
  round({far.x(), corner.y() + ry});
  to.line_to({far.x(), far.y() - ry});
  round({far.x() - rx, far.y()});
  to.line_to({corner.x() + rx, far.y()});
  round({corner.x(), far.y() - ry});
  to.line_to({corner.x(), corner.y() + ry});
  round({corner.x() + rx, corner.y()});
  to.close();
}

/// The data of path("...") as CSS has it in the property d; the attribute's otherwise.
std::string_view path_data(const pugi::xml_node& node, const SvgValues::Value& value) {
  if (value.attribute) return value.text;
  const std::string_view text = value.text;
  const std::size_t open = text.find_first_of("\"'"), close = text.find_last_of("\"'");
  if (same_word(text, "none") || (text.starts_with("path(") && open != close))
    return open == std::string_view::npos ? std::string_view() : text.substr(open + 1, close - open - 1);
  return node.attribute("d").value();
}

}  // namespace

bool is_svg_shape(std::string_view local_name) {
  constexpr std::string_view shapes[] = {"path", "rect", "circle", "ellipse", "line", "polyline", "polygon"};
  return std::find(std::begin(shapes), std::end(shapes), local_name) != std::end(shapes);
}

double SvgLengths::of(SvgProperty property, double whole, double absent) const {
  const SvgValues::Value& value = values_[property];
  if (!value.attribute && !value.text.empty()) {
    // Browsers drop a bare number in a sheet, and what the attribute says holds.
    const auto length = read_length(value.text);
    const bool dropped = !length || (length->unitless && length->value != 0);
    if (dropped && !same_word(value.text, "auto")) {
      constexpr std::pair<SvgProperty, const char*> names[] = {
          {SvgProperty::x, "x"},           {SvgProperty::y, "y"},   {SvgProperty::width, "width"},
          {SvgProperty::height, "height"}, {SvgProperty::cx, "cx"}, {SvgProperty::cy, "cy"},
          {SvgProperty::r, "r"},           {SvgProperty::rx, "rx"}, {SvgProperty::ry, "ry"}};
      for (const auto& [known, name] : names)
        if (known == property) return read(node_.attribute(name).value(), whole, absent);
    }
  }
  return read(value.text, whole, absent);
}

double SvgLengths::read(std::string_view text, double whole, double absent) const {
  if (text.empty() || same_word(text, "auto")) return absent;
  const auto value = read_length(text);
  if (value) return LengthBase{whole, font_size_}.of(*value);
  ++malformed_;
  return absent;
}

bool draw_svg_shape(const pugi::xml_node& node, const SvgValues& values, const SvgLengths& lengths, CurveFlattener& to,
                    DrawingLimits& limits) {
  using P = SvgProperty;
  const std::string_view name = svg_local_name(node);
  if (name == "path") {
    const std::string_view data = path_data(node, values[P::d]);
    limits.add_steps(2 * data.size());
    return draw_path_data(data, to);
  }
  if (name == "polyline" || name == "polygon") {
    std::string_view points = node.attribute("points").value();
    limits.add_steps(2 * points.size());
    // Letters would be commands.
    const std::size_t end = std::min(points.find_first_not_of("0123456789+-.eE, \t\r\n"), points.size());
    const bool sound = end == points.size();
    points = without_blanks(points.substr(0, end));
    if (points.empty()) return sound;
    const bool drawn = draw_path_data("M" + std::string(points), to);
    if (name == "polygon") to.close();
    return drawn && sound;
  }
  if (name == "line") {
    to.move_to({lengths.x("x1"), lengths.y("y1")});
    to.line_to({lengths.x("x2"), lengths.y("y2")});
  } else if (name == "circle") {
    if (const double r = lengths.any(P::r); r > 0) to.ellipse({lengths.x(P::cx), lengths.y(P::cy)}, r, r);
  } else if (name == "ellipse") {
    double rx = lengths.x(P::rx, -1), ry = lengths.y(P::ry, -1);
    if (rx < 0) rx = ry;
    if (ry < 0) ry = rx;
    if (rx > 0 && ry > 0) to.ellipse({lengths.x(P::cx), lengths.y(P::cy)}, rx, ry);
  } else if (name == "rect") {
    draw_rectangle(to, {lengths.x(P::x), lengths.y(P::y)}, {lengths.x(P::width), lengths.y(P::height)},
                   lengths.x(P::rx, -1), lengths.y(P::ry, -1));
  }
  return true;
}

}  // namespace formwright
