// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/svg/style/css_selector.h"

#include <algorithm>
#include <charconv>

#include "fabrication/svg/grammar/svg_grammar.h"

namespace formwright {
namespace {

using Kind = CssCondition::Kind;
using Compare = CssCondition::Compare;
using Join = CssCondition::Join;

constexpr std::size_t max_conditions = 32;

bool is_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_' ||
         static_cast<unsigned char>(c) >= 0x80;
}

std::string_view take_name(std::string_view& text) {
  const auto end = std::find_if_not(text.begin(), text.end(), is_name);
  const std::string_view name = text.substr(0, static_cast<std::size_t>(end - text.begin()));
  text.remove_prefix(name.size());
  return name;
}

/// "odd", "even", "3", "2n+1", "-n + 3".
bool read_nth(std::string_view text, CssCondition& condition) {
  text = without_blanks(text);
  const auto whole = [](std::string_view digits, int& value) {
    if (digits.starts_with('+')) digits.remove_prefix(1);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    return error == std::errc() && end == digits.data() + digits.size() && std::abs(value) < 1'000'000;
  };
  if (same_word(text, "odd") || same_word(text, "even")) {
    condition.step = 2;
    condition.offset = same_word(text, "odd") ? 1 : 0;
    return true;
  }
  const std::size_t n = text.find_first_of("nN");
  if (n == std::string_view::npos) return whole(text, condition.offset);
  const std::string_view step = text.substr(0, n), offset = without_blanks(text.substr(n + 1));
  if (step.empty() || step == "+") condition.step = 1;
  else if (step == "-") condition.step = -1;
  else if (!whole(step, condition.step)) return false;
  if (offset.empty()) return true;
  if (offset.front() != '+' && offset.front() != '-') return false;
  if (!whole(without_blanks(offset.substr(1)), condition.offset)) return false;
  if (offset.front() == '-') condition.offset = -condition.offset;
  return true;
}

bool read_pseudo_class(std::string_view& text, CssCondition& condition) {
  if (text.starts_with(':')) return false;  // of parts of an element, which drawings do not have
  const std::string_view name = take_name(text);
  std::string_view inside;
  if (text.starts_with('(')) {
    const std::size_t close = text.find(')');
    if (close == std::string_view::npos) return false;
    inside = text.substr(1, close - 1);
    text.remove_prefix(close + 1);
  }
  condition.offset = 1;
  if (same_word(name, "root")) condition.kind = Kind::root;
  else if (same_word(name, "first-child")) condition.kind = Kind::nth_child;
  else if (same_word(name, "last-child")) condition.kind = Kind::nth_last_child;
  else if (same_word(name, "only-child")) condition.kind = Kind::only_child;
  else if (same_word(name, "nth-child") || same_word(name, "nth-last-child")) {
    condition.kind = same_word(name, "nth-child") ? Kind::nth_child : Kind::nth_last_child;
    condition.offset = 0;
    return read_nth(inside, condition);
  } else {
    // What somebody points at: never in a file.
    constexpr std::string_view interactive[] = {"hover", "active", "focus", "visited", "target"};
    return std::any_of(std::begin(interactive), std::end(interactive),
                       [&](std::string_view known) { return same_word(name, known); });
  }
  return true;
}

/// Behind the [.
bool read_attribute(std::string_view& text, CssCondition& condition) {
  condition.kind = Kind::attribute;
  text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
  const std::size_t end = std::min(text.find_first_of(" \t\r\n\f=~|^$*]"), text.size());
  condition.name = text.substr(0, end);
  text.remove_prefix(end);
  text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
  if (condition.name.empty() || text.empty()) return false;
  if (text.front() == ']') {
    text.remove_prefix(1);
    return true;
  }
  constexpr std::string_view marks = "=~|^$*";
  const std::size_t kind = marks.find(text.front());
  if (kind == std::string_view::npos) return false;
  condition.compare = static_cast<Compare>(kind + 1);
  text.remove_prefix(1);
  if (kind > 0) {
    if (!text.starts_with('=')) return false;
    text.remove_prefix(1);
  }
  text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
  if (text.empty()) return false;
  std::size_t value_end = 0;
  if (text.front() == '"' || text.front() == '\'') {
    value_end = text.find(text.front(), 1);
    if (value_end == std::string_view::npos) return false;
    condition.value = text.substr(1, value_end - 1);
    ++value_end;
  } else {
    condition.value = take_name(text);
  }
  text.remove_prefix(value_end);
  text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
  if (!text.starts_with(']')) return false;
  text.remove_prefix(1);
  return true;
}

/// One of "path", "*", "#a", ".a", "[a=b]", ":root". "*" is left out: `kind` then stays never and `name` is "*".
bool read_condition(std::string_view& text, CssCondition& condition) {
  const char c = text.front();
  if (c == '*' || is_name(c)) {
    if (c == '*') text.remove_prefix(1);
    else condition.name = take_name(text);
    if (text.starts_with('|')) {  // of a namespace
      text.remove_prefix(1);
      condition.name = take_name(text);
      if (condition.name.empty() && text.starts_with('*')) text.remove_prefix(1);
    }
    if (condition.name.empty()) condition.name = "*";
    else condition.kind = Kind::element;
    return true;
  }
  text.remove_prefix(1);
  if (c == '#' || c == '.') {
    condition.kind = c == '#' ? Kind::id : Kind::of_class;
    condition.name = take_name(text);
    return !condition.name.empty() && !text.starts_with('\\');
  }
  if (c == '[') return read_attribute(text, condition);
  return c == ':' && read_pseudo_class(text, condition);
}

std::uint32_t specificity_of(const CssCondition& condition) {
  if (condition.kind == Kind::id) return 1 << 20;
  return condition.kind == Kind::element ? 1 : 1 << 10;
}

/// Its place among its parent's elements, from 1, counted from either end.
int place_of(pugi::xml_node node, bool from_end, DrawingLimits& limits) {
  int place = 1;
  while ((node = from_end ? node.next_sibling() : node.previous_sibling())) {
    limits.add_steps(1);
    if (node.type() == pugi::node_element) ++place;
  }
  return place;
}

bool nth(int place, const CssCondition& condition) {
  const int left = place - condition.offset;
  if (condition.step == 0) return left == 0;
  return left % condition.step == 0 && left / condition.step >= 0;
}

bool has_word(std::string_view text, std::string_view wanted) {
  for (std::size_t at = 0; (at = text.find(wanted, at)) != std::string_view::npos; at += wanted.size()) {
    const std::size_t end = at + wanted.size();
    const bool begins = at == 0 || blanks.find(text[at - 1]) != std::string_view::npos;
    if (begins && (end == text.size() || blanks.find(text[end]) != std::string_view::npos)) return true;
  }
  return false;
}

bool attribute_matches(const CssCondition& condition, const pugi::xml_node& node, DrawingLimits& limits) {
  for (const pugi::xml_attribute& attribute : node.attributes()) {
    if (condition.name != attribute.name()) continue;
    const std::string_view value = attribute.value(), wanted = condition.value;
    limits.add_steps(value.size());
    switch (condition.compare) {
      case Compare::exists: return true;
      case Compare::equal: return value == wanted;
      case Compare::word: return !wanted.empty() && has_word(value, wanted);
      case Compare::dash:
        return value.starts_with(wanted) && (value.size() == wanted.size() || value[wanted.size()] == '-');
      case Compare::begins: return !wanted.empty() && value.starts_with(wanted);
      case Compare::ends: return !wanted.empty() && value.ends_with(wanted);
      case Compare::contains: return !wanted.empty() && value.find(wanted) != std::string_view::npos;
    }
  }
  return false;
}

bool holds(const CssCondition& condition, const pugi::xml_node& node, DrawingLimits& limits) {
  limits.add_steps(2);
  switch (condition.kind) {
    case Kind::element: return condition.name == svg_local_name(node);
    case Kind::id: return condition.name == node.attribute("id").value();
    case Kind::of_class: {
      const std::string_view classes = node.attribute("class").value();
      limits.add_steps(classes.size() / 8);
      return has_word(classes, condition.name);
    }
    case Kind::attribute: return attribute_matches(condition, node, limits);
    case Kind::root: return node.parent() == node.root();
    case Kind::nth_child: return nth(place_of(node, false, limits), condition);
    case Kind::nth_last_child: return nth(place_of(node, true, limits), condition);
    case Kind::only_child: return place_of(node, false, limits) == 1 && place_of(node, true, limits) == 1;
    case Kind::never: break;
  }
  return condition.name == "*";
}

pugi::xml_node element_before(pugi::xml_node node) {
  do node = node.previous_sibling();
  while (node && node.type() != pugi::node_element);
  return node;
}

pugi::xml_node element_around(const pugi::xml_node& node) {
  const pugi::xml_node parent = node.parent();
  return parent.type() == pugi::node_element ? parent : pugi::xml_node();
}

}  // namespace

std::string_view svg_local_name(const pugi::xml_node& node) {
  const std::string_view name = node.name();
  const std::size_t colon = name.find(':');
  return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

bool read_css_selector(std::string_view text, CssSelector& selector) {
  text = without_blanks(text);
  Join join = Join::same;
  while (!text.empty()) {
    if (selector.conditions.size() == max_conditions) return false;
    CssCondition condition;
    if (text.starts_with(":not(")) {
      text.remove_prefix(5);
      text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
      if (text.empty() || !read_condition(text, condition)) return false;
      text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
      if (!text.starts_with(')')) return false;
      text.remove_prefix(1);
      condition.negated = true;
    } else if (!read_condition(text, condition)) {
      return false;
    }
    condition.join = join;
    join = Join::same;
    if (condition.name != "*") selector.specificity += specificity_of(condition);
    selector.conditions.push_back(condition);
    const std::size_t next = text.find_first_not_of(blanks);
    if (next == std::string_view::npos) break;
    constexpr std::string_view marks = ">+~";
    const std::size_t mark = marks.find(text[next]);
    if (mark != std::string_view::npos) {
      join = static_cast<Join>(static_cast<std::size_t>(Join::child) + mark);
      text = without_blanks(text.substr(next + 1));
      if (text.empty()) return false;
    } else if (next > 0) {
      join = Join::descendant;
      text.remove_prefix(next);
    }
  }
  if (selector.conditions.empty()) return false;
  // Read from the left, a join says how its condition stands to the one before; from the right, the one before to it.
  std::reverse(selector.conditions.begin(), selector.conditions.end());
  for (std::size_t i = selector.conditions.size(); i-- > 1;)
    selector.conditions[i].join = selector.conditions[i - 1].join;
  selector.conditions.front().join = Join::same;
  return true;
}

bool has_class(std::string_view classes, std::string_view wanted) { return has_word(classes, wanted); }

bool matches(const CssCondition* first, const CssCondition* end, const pugi::xml_node& node, DrawingLimits& limits) {
  const CssCondition* at = first;
  do {
    if (holds(*at, node, limits) == at->negated) return false;
    ++at;
  } while (at < end && at->join == Join::same);
  if (at == end) return true;
  pugi::xml_node other = node;
  switch (at->join) {
    case Join::child: other = element_around(node); return other && matches(at, end, other, limits);
    case Join::next_sibling: other = element_before(node); return other && matches(at, end, other, limits);
    case Join::later_sibling:
      while ((other = element_before(other)))
        if (matches(at, end, other, limits)) return true;
      return false;
    case Join::descendant:
      while ((other = element_around(other)))
        if (matches(at, end, other, limits)) return true;
      return false;
    case Join::same: break;
  }
  return false;
}

}  // namespace formwright
