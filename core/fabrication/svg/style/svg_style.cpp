// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/svg/style/svg_style.h"

#include <algorithm>
#include <optional>

#include "fabrication/svg/grammar/svg_grammar.h"

namespace formwright {
namespace {

constexpr std::string_view property_names[svg_property_count] = {"clip-path",
                                                                 "clip-rule",
                                                                 "color",
                                                                 "cx",
                                                                 "cy",
                                                                 "d",
                                                                 "display",
                                                                 "fill",
                                                                 "fill-opacity",
                                                                 "fill-rule",
                                                                 "filter",
                                                                 "font-size",
                                                                 "height",
                                                                 "marker",
                                                                 "marker-end",
                                                                 "marker-mid",
                                                                 "marker-start",
                                                                 "mask",
                                                                 "opacity",
                                                                 "overflow",
                                                                 "r",
                                                                 "rotate",
                                                                 "rx",
                                                                 "ry",
                                                                 "scale",
                                                                 "stroke",
                                                                 "stroke-dasharray",
                                                                 "stroke-dashoffset",
                                                                 "stroke-opacity",
                                                                 "stroke-width",
                                                                 "transform",
                                                                 "transform-box",
                                                                 "transform-origin",
                                                                 "translate",
                                                                 "vector-effect",
                                                                 "visibility",
                                                                 "width",
                                                                 "x",
                                                                 "y"};
static_assert(std::is_sorted(std::begin(property_names), std::end(property_names)));

/// `name` as an attribute is in the case that SVG has it in; in a sheet any case will do.
std::optional<SvgProperty> property_of(std::string_view name) {
  // These four are no attributes: `rotate` turns letters, the others mean nothing.
  if (name == "marker" || name == "rotate" || name == "scale" || name == "translate") return std::nullopt;
  const auto found = std::lower_bound(std::begin(property_names), std::end(property_names), name);
  if (found == std::end(property_names) || *found != name) return std::nullopt;
  return static_cast<SvgProperty>(found - std::begin(property_names));
}

std::optional<SvgProperty> property_in_css(std::string_view name) {
  for (int i = 0; i < svg_property_count; ++i)
    if (same_word(name, property_names[i])) return static_cast<SvgProperty>(i);
  return std::nullopt;
}

/// The first class, id or element name that a selector asks of the element itself.
const CssCondition* key_of(const CssSelector& selector) {
  const CssCondition* best = nullptr;
  for (const CssCondition& condition : selector.conditions) {
    if (condition.join != CssCondition::Join::same) break;
    using Kind = CssCondition::Kind;
    if (condition.negated) continue;
    if (condition.kind == Kind::id) return &condition;
    if (condition.kind == Kind::of_class || (condition.kind == Kind::element && best == nullptr)) best = &condition;
  }
  return best;
}

}  // namespace

StyleSheet::StyleSheet(const pugi::xml_node& root, DrawingLimits& limits) : limits_(limits) {
  struct Finder : pugi::xml_tree_walker {
    StyleSheet* sheet = nullptr;
    bool for_each(pugi::xml_node& node) override {
      if (node.type() != pugi::node_element) return true;
      if (pugi::xml_attribute style = node.attribute("style");
          std::string_view(style.value()).find("/*") != std::string_view::npos)
        style.set_value(without_css_comments(style.value()).c_str());
      const std::string_view type = node.attribute("type").value();
      if (svg_local_name(node) != "style" || (!type.empty() && !same_word(type, "text/css"))) return true;
      const MediaMatch media = match_media(node.attribute("media").value());
      if (media == MediaMatch::unknown) ++sheet->not_followed_;
      if (media != MediaMatch::yes) return true;
      std::string css;
      for (const pugi::xml_node& child : node.children()) css += child.value();
      sheet->read(css);
      return true;
    }
  } finder;
  finder.sheet = this;
  pugi::xml_node whole = root;
  finder.for_each(whole);
  whole.traverse(finder);
  std::sort(keys_.begin(), keys_.end());
}

void StyleSheet::read(const std::string& css) {
  sheets_.push_back(without_css_comments(css));
  CssSheetEvents events;
  events.not_followed = [&](std::string_view) { ++not_followed_; };
  events.rule = [&](std::string_view selectors, std::string_view block) {
    limits_.add_steps(selectors.size() + block.size());
    const std::size_t first = declarations_.size();
    read_css_declarations(block, [&](const CssDeclaration& declaration) {
      if (const auto property = property_in_css(declaration.name))
        declarations_.push_back({*property, declaration.important, declaration.value});
    });
    if (declarations_.size() == first) return;
    while (!selectors.empty()) {
      const std::size_t comma = std::min(selectors.find(','), selectors.size());
      CssSelector selector;
      const bool followed = read_css_selector(selectors.substr(0, comma), selector);
      selectors.remove_prefix(std::min(comma + 1, selectors.size()));
      if (!followed) {
        ++not_followed_;
        continue;
      }
      const auto number = static_cast<std::uint32_t>(rules_.size());
      const CssCondition* key = key_of(selector);
      keys_.push_back({key ? key->kind : CssCondition::Kind::never, key ? key->name : std::string_view(), number});
      rules_.push_back({static_cast<std::uint32_t>(conditions_.size()),
                        static_cast<std::uint32_t>(selector.conditions.size()), static_cast<std::uint32_t>(first),
                        static_cast<std::uint32_t>(declarations_.size() - first), selector.specificity});
      conditions_.insert(conditions_.end(), selector.conditions.begin(), selector.conditions.end());
    }
  };
  read_css_sheet(sheets_.back(), events);
}

void StyleSheet::add_candidates(CssCondition::Kind kind, std::string_view name,
                                std::vector<std::uint32_t>& candidates) {
  const Key wanted{kind, name, 0};
  for (auto at = std::lower_bound(keys_.begin(), keys_.end(), wanted);
       at != keys_.end() && at->kind == kind && at->name == name; ++at) {
    limits_.add_steps(16);
    candidates.push_back(at->rule);
  }
}

std::unique_ptr<const SvgValues> StyleSheet::values_of(const pugi::xml_node& element) {
  using Kind = CssCondition::Kind;
  auto result = std::make_unique<SvgValues>();
  SvgValues& values = *result;
  std::string_view style, classes;
  for (const pugi::xml_attribute& attribute : element.attributes()) {
    const std::string_view name = attribute.name(), value = attribute.value();
    limits_.add_steps(4 + value.size() / 8);
    if (name == "style") style = value;
    else if (name == "class") classes = value;
    else if (const auto property = property_of(name))
      values.of[static_cast<std::size_t>(*property)] = {without_blanks(value), true};
  }
  std::vector<std::uint32_t> candidates;
  if (!rules_.empty()) {
    add_candidates(Kind::never, "", candidates);
    add_candidates(Kind::element, svg_local_name(element), candidates);
    if (const char* id = element.attribute("id").value(); *id != 0) add_candidates(Kind::id, id, candidates);
    while (!classes.empty()) {
      const std::string_view one = classes.substr(0, std::min(classes.find_first_of(" \t\r\n"), classes.size()));
      if (!one.empty()) add_candidates(Kind::of_class, one, candidates);
      classes.remove_prefix(std::min(one.size() + 1, classes.size()));
    }
    std::erase_if(candidates, [&](std::uint32_t rule) {
      const CssCondition* first = conditions_.data() + rules_[rule].first_condition;
      return !matches(first, first + rules_[rule].condition_count, element, limits_);
    });
    // Later rules win among equals.
    std::sort(candidates.begin(), candidates.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(rules_[a].specificity, a) < std::pair(rules_[b].specificity, b);
    });
  }
  const auto apply_rules = [&](bool important) {
    for (const std::uint32_t number : candidates) {
      const Rule& rule = rules_[number];
      limits_.add_steps(rule.declaration_count);
      for (std::uint32_t i = 0; i < rule.declaration_count; ++i) {
        const Declaration& declaration = declarations_[rule.first_declaration + i];
        if (declaration.important == important)
          values.of[static_cast<std::size_t>(declaration.property)] = {declaration.value, false};
      }
    }
  };
  const auto apply_style = [&](bool important) {
    limits_.add_steps(2 * style.size());
    read_css_declarations(style, [&](const CssDeclaration& declaration) {
      if (declaration.important != important) return;
      if (const auto property = property_in_css(declaration.name))
        values.of[static_cast<std::size_t>(*property)] = {declaration.value, false};
    });
  };
  apply_rules(false);
  if (!style.empty()) apply_style(false);
  apply_rules(true);
  if (style.find('!') != std::string_view::npos) apply_style(true);
  return result;
}

}  // namespace formwright
