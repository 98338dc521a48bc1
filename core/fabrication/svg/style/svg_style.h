// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What an SVG element says of each property: attributes, <style> sheets, style="...", in the order of CSS Cascade 4.
#include <array>
#include <deque>
#include <memory>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "fabrication/svg/style/css_selector.h"
#include "fabrication/svg/style/css_syntax.h"

namespace formwright {

/// The properties that change where lines are or which layer they belong to.
enum class SvgProperty {
  clip_path,
  clip_rule,
  color,
  cx,
  cy,
  d,
  display,
  fill,
  fill_opacity,
  fill_rule,
  filter,
  font_size,
  height,
  marker,
  marker_end,
  marker_mid,
  marker_start,
  mask,
  opacity,
  overflow,
  r,
  rotate,
  rx,
  ry,
  scale,
  stroke,
  stroke_dasharray,
  stroke_dashoffset,
  stroke_opacity,
  stroke_width,
  transform,
  transform_box,
  transform_origin,
  translate,
  vector_effect,
  visibility,
  width,
  x,
  y
};
inline constexpr int svg_property_count = static_cast<int>(SvgProperty::y) + 1;

/// What is said of one element; "" where nothing is. Views into the document and its sheets.
struct SvgValues {
  struct Value {
    std::string_view text;
    bool attribute = false;  // of the grammar of attributes, where a bare number is a length
  };
  std::array<Value, svg_property_count> of;

  const Value& operator[](SvgProperty property) const { return of[static_cast<std::size_t>(property)]; }
};

/// The document's <style> elements. The document must outlive it.
class StyleSheet {
 public:
  /// Comments in style attributes are taken out of the document.
  StyleSheet(const pugi::xml_node& root, DrawingLimits& limits);

  /// On the heap: in the page's WebAssembly the stack is small, and elements nest.
  std::unique_ptr<const SvgValues> values_of(const pugi::xml_node& element);

  std::size_t not_followed() const { return not_followed_; }  // selectors and rules

 private:
  struct Declaration {
    SvgProperty property;
    bool important;
    std::string_view value;
  };
  struct Rule {
    std::uint32_t first_condition, condition_count, first_declaration, declaration_count, specificity;
  };
  /// The rules that a name of an element can fulfil.
  struct Key {
    CssCondition::Kind kind;
    std::string_view name;
    std::uint32_t rule;
    bool operator<(const Key& other) const {
      return std::tie(kind, name, rule) < std::tie(other.kind, other.name, other.rule);
    }
  };
  void read(const std::string& css);
  void add_candidates(CssCondition::Kind kind, std::string_view name, std::vector<std::uint32_t>& candidates);

  DrawingLimits& limits_;
  std::deque<std::string> sheets_;
  std::vector<CssCondition> conditions_;
  std::vector<Declaration> declarations_;
  std::vector<Rule> rules_;
  std::vector<Key> keys_;
  std::size_t not_followed_ = 0;
};

}  // namespace formwright
