// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The basic shapes and paths of SVG as lines (SVG 2, chapters 9 and 10).
#include <pugixml.hpp>
#include <string_view>

#include "fabrication/svg/grammar/curve_flattening.h"
#include "fabrication/svg/style/svg_style.h"
#include "fabrication/svg/svg_viewport.h"

namespace formwright {

bool is_svg_shape(std::string_view local_name);

/// Lengths of one element.
class SvgLengths {
 public:
  SvgLengths(const pugi::xml_node& node, const SvgValues& values, const ViewportSize& viewport, double font_size,
             std::size_t& malformed)
      : node_(node), values_(values), viewport_(viewport), font_size_(font_size), malformed_(malformed) {}

  double x(SvgProperty property, double absent = 0) const { return of(property, viewport_.width, absent); }
  double y(SvgProperty property, double absent = 0) const { return of(property, viewport_.height, absent); }
  double any(SvgProperty property, double absent = 0) const { return of(property, viewport_.diagonal(), absent); }
  /// Of attributes that are no properties.
  double x(const char* attribute) const { return read(node_.attribute(attribute).value(), viewport_.width, 0); }
  double y(const char* attribute) const { return read(node_.attribute(attribute).value(), viewport_.height, 0); }

 private:
  double of(SvgProperty property, double whole, double absent) const;
  double read(std::string_view text, double whole, double absent) const;

  const pugi::xml_node& node_;
  const SvgValues& values_;
  const ViewportSize& viewport_;
  double font_size_;
  std::size_t& malformed_;
};

/// False when the shape has a fault: it is drawn as far as it goes.
bool draw_svg_shape(const pugi::xml_node& node, const SvgValues& values, const SvgLengths& lengths, CurveFlattener& to,
                    DrawingLimits& limits);

}  // namespace formwright
