// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How an SVG element is painted: attributes, style="..." and the classes of <style> sheets.
#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <pugixml.hpp>

namespace formwright {

/// Rules of the document's <style> elements whose selector is an element, a class, an id or two of them joined
/// ("path.st0"). Selectors that look at ancestors are not followed.
class StyleSheet {
 public:
  explicit StyleSheet(const pugi::xml_node& root);

  /// The property as it is said for this very element; "" when it is not.
  std::string property(const pugi::xml_node& element, std::string_view name) const;

 private:
  struct Rule {
    std::string element, of_class, id;
    std::map<std::string, std::string, std::less<>> properties;
  };
  void read(std::string_view css);
  std::vector<Rule> rules_;
};

/// "#f00", "#ff0000", "rgb(255, 0, 0)", "rgb(100%,0%,0%)" or one of the plain names. None for paints that are not one
/// colour.
std::optional<std::array<int, 3>> read_colour(std::string_view text);

}  // namespace formwright
