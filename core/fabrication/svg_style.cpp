// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/svg_style.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <utility>

#include "base/number_list.h"

namespace formwright {
namespace {

std::string trimmed(std::string_view text) {
  const auto blank = [](char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return std::string(text);
}

std::map<std::string, std::string, std::less<>> read_declarations(std::string_view text) {
  std::map<std::string, std::string, std::less<>> result;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(';'), text.size());
    const std::string_view one = text.substr(0, end);
    if (const std::size_t colon = one.find(':'); colon != std::string_view::npos) {
      std::string value = trimmed(one.substr(colon + 1));
      if (const std::size_t mark = value.find('!'); mark != std::string::npos) value = trimmed(value.substr(0, mark));
      result[trimmed(one.substr(0, colon))] = std::move(value);
    }
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return result;
}

std::string_view local_name(const pugi::xml_node& element) {
  const std::string_view name = element.name();
  const std::size_t colon = name.find(':');
  return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

bool has_class(std::string_view classes, std::string_view wanted) {
  for (std::size_t at = 0; (at = classes.find(wanted, at)) != std::string_view::npos; at += wanted.size()) {
    const bool begins = at == 0 || std::isspace(static_cast<unsigned char>(classes[at - 1]));
    const std::size_t end = at + wanted.size();
    if (begins && (end == classes.size() || std::isspace(static_cast<unsigned char>(classes[end])))) return true;
  }
  return false;
}

}  // namespace

StyleSheet::StyleSheet(const pugi::xml_node& root) {
  struct Finder : pugi::xml_tree_walker {
    std::string css;
    bool for_each(pugi::xml_node& node) override {
      if (node.type() == pugi::node_element && local_name(node) == "style")
        for (const pugi::xml_node& child : node.children()) css += child.value();
      return true;
    }
  } finder;
  pugi::xml_node(root).traverse(finder);
  read(finder.css);
}

void StyleSheet::read(std::string_view css) {
  std::string plain;  // without comments
  for (std::size_t at = 0; at < css.size();) {
    if (css.substr(at, 2) == "/*") {
      const std::size_t end = css.find("*/", at + 2);
      at = end == std::string_view::npos ? css.size() : end + 2;
    } else {
      plain += css[at++];
    }
  }
  for (std::string_view rest = plain; !rest.empty();) {
    const std::size_t open = rest.find('{');
    if (open == std::string_view::npos) break;
    const std::size_t close = std::min(rest.find('}', open), rest.size());
    std::string_view selectors = rest.substr(0, open);
    const auto properties = read_declarations(rest.substr(open + 1, close - open - 1));
    while (!selectors.empty()) {
      const std::size_t comma = std::min(selectors.find(','), selectors.size());
      const std::string selector = trimmed(selectors.substr(0, comma));
      selectors.remove_prefix(std::min(comma + 1, selectors.size()));
      if (selector.empty() || selector.find_first_of(" >+~[:@") != std::string::npos) continue;
      Rule rule;
      rule.properties = properties;
      std::string* part = &rule.element;
      for (const char c : selector) {
        if (c == '.') part = &rule.of_class;
        else if (c == '#') part = &rule.id;
        else *part += c;
      }
      if (rule.element == "*") rule.element.clear();
      rules_.push_back(std::move(rule));
    }
    rest.remove_prefix(std::min(close + 1, rest.size()));
  }
  // Later rules win among equals, ids over classes over elements.
  std::stable_sort(rules_.begin(), rules_.end(), [](const Rule& a, const Rule& b) {
    return std::pair(!a.id.empty(), !a.of_class.empty()) < std::pair(!b.id.empty(), !b.of_class.empty());
  });
}

std::string StyleSheet::property(const pugi::xml_node& element, std::string_view name) const {
  const auto own = read_declarations(element.attribute("style").value());
  if (const auto found = own.find(name); found != own.end()) return found->second;
  for (auto rule = rules_.rbegin(); rule != rules_.rend(); ++rule) {
    if (!rule->element.empty() && rule->element != local_name(element)) continue;
    if (!rule->of_class.empty() && !has_class(element.attribute("class").value(), rule->of_class)) continue;
    if (!rule->id.empty() && rule->id != element.attribute("id").value()) continue;
    if (const auto found = rule->properties.find(name); found != rule->properties.end()) return found->second;
  }
  return trimmed(element.attribute(std::string(name).c_str()).value());
}

std::optional<std::array<int, 3>> read_colour(std::string_view text) {
  std::string word = trimmed(text);
  std::transform(word.begin(), word.end(), word.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (word.starts_with('#')) {
    if (word.find_first_not_of("0123456789abcdef", 1) != std::string::npos) return std::nullopt;
    const auto digit = [&](std::size_t i) { return word[i] <= '9' ? word[i] - '0' : word[i] - 'a' + 10; };
    if (word.size() == 4 || word.size() == 5) return std::array{17 * digit(1), 17 * digit(2), 17 * digit(3)};
    if (word.size() == 7 || word.size() == 9)
      return std::array{16 * digit(1) + digit(2), 16 * digit(3) + digit(4), 16 * digit(5) + digit(6)};
    return std::nullopt;
  }
  if (word.starts_with("rgb")) {
    const bool percent = word.find('%') != std::string::npos;
    std::erase(word, '%');
    const std::size_t open = word.find('('), close = word.find(')');
    if (open == std::string::npos || close == std::string::npos || close < open) return std::nullopt;
    const auto numbers = read_number_list(std::string_view(word).substr(open + 1, close - open - 1));
    if (!numbers || numbers->size() < 3) return std::nullopt;
    std::array<int, 3> rgb{};
    for (std::size_t i = 0; i < 3; ++i)
      rgb[i] = static_cast<int>(std::lround(std::clamp((*numbers)[i] * (percent ? 2.55 : 1), 0.0, 255.0)));
    return rgb;
  }
  constexpr std::pair<std::string_view, std::array<int, 3>> names[] = {
      {"black", {0, 0, 0}},        {"red", {255, 0, 0}},       {"blue", {0, 0, 255}},      {"green", {0, 128, 0}},
      {"lime", {0, 255, 0}},       {"white", {255, 255, 255}}, {"gray", {128, 128, 128}},  {"grey", {128, 128, 128}},
      {"silver", {192, 192, 192}}, {"maroon", {128, 0, 0}},    {"navy", {0, 0, 128}},      {"yellow", {255, 255, 0}},
      {"magenta", {255, 0, 255}},  {"fuchsia", {255, 0, 255}}, {"cyan", {0, 255, 255}},    {"aqua", {0, 255, 255}},
      {"orange", {255, 165, 0}},   {"purple", {128, 0, 128}},  {"teal", {0, 128, 128}},    {"olive", {128, 128, 0}},
      {"darkred", {139, 0, 0}},    {"darkblue", {0, 0, 139}},  {"darkgreen", {0, 100, 0}}, {"crimson", {220, 20, 60}},
      {"mediumblue", {0, 0, 205}}};
  for (const auto& [name, rgb] : names)
    if (word == name) return rgb;
  return std::nullopt;
}

}  // namespace formwright
