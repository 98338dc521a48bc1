// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Selectors of CSS (Selectors 3): element, class, id, attribute, some pseudo-classes; descendant, child, sibling.
#include <cstdint>
#include <pugixml.hpp>
#include <string_view>
#include <vector>

#include "fabrication/svg/grammar/drawing_limits.h"

namespace formwright {

/// Without the prefix of its namespace.
std::string_view svg_local_name(const pugi::xml_node& node);

/// One condition on one element.
struct CssCondition {
  enum class Kind : std::uint8_t {
    element,
    id,
    of_class,
    attribute,
    root,
    nth_child,
    nth_last_child,
    only_child,
    never
  };
  enum class Compare : std::uint8_t { exists, equal, word, dash, begins, ends, contains };
  /// How the element of this condition stands to the one on its right; `same` joins conditions on one element.
  enum class Join : std::uint8_t { same, descendant, child, next_sibling, later_sibling };
  Kind kind = Kind::never;
  Compare compare = Compare::exists;
  Join join = Join::same;
  bool negated = false;
  int step = 0, offset = 0;      // nth_child: step * n + offset
  std::string_view name, value;  // views into the sheet
};

/// Conditions from the right to the left: what is said of the element itself comes first.
struct CssSelector {
  std::vector<CssCondition> conditions;
  std::uint32_t specificity = 0;  // ids, classes, elements: ten bits each
};

/// False when it has something that is not followed; it is then no selector of ours. Views into `text`.
bool read_css_selector(std::string_view text, CssSelector& selector);

bool has_class(std::string_view classes, std::string_view wanted);

/// Conditions as in CssSelector.
bool matches(const CssCondition* first, const CssCondition* end, const pugi::xml_node& node, DrawingLimits& limits);

}  // namespace formwright
