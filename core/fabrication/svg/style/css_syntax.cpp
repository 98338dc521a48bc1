// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/svg/style/css_syntax.h"

#include <algorithm>

#include "fabrication/svg/grammar/svg_grammar.h"

namespace formwright {
namespace {

constexpr int max_nested_blocks = 8;

/// Behind the string that begins at `at`.
std::size_t string_end(std::string_view text, std::size_t at) {
  const char quote = text[at];
  for (++at; at < text.size() && text[at] != quote; ++at)
    if (text[at] == '\\') ++at;
  return std::min(at + 1, text.size());
}

/// Where the first of `ends` stands that is in no string and no brackets; the text's size when there is none.
std::size_t find_outside(std::string_view text, std::string_view ends) {
  std::size_t open = 0;
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    if (open == 0 && ends.find(c) != std::string_view::npos) return at;
    if (c == '"' || c == '\'') {
      at = string_end(text, at);
      continue;
    }
    if (c == '\\') ++at;
    if (c == '(' || c == '[') ++open;
    if ((c == ')' || c == ']') && open > 0) --open;
    ++at;
  }
  return text.size();
}

/// Where the } stands that closes the block whose inside `text` begins with.
std::size_t block_end(std::string_view text) {
  std::size_t open = 1;
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    if (c == '"' || c == '\'') {
      at = string_end(text, at);
      continue;
    }
    if (c == '\\') ++at;
    if (c == '{') ++open;
    if (c == '}' && --open == 0) return at;
    ++at;
  }
  return text.size();
}

std::string_view rest_of(std::string_view text, std::size_t from) { return text.substr(std::min(from, text.size())); }

void read_rules(std::string_view css, const CssSheetEvents& events, int nested) {
  while (!(css = without_blanks(css)).empty()) {
    const bool at_rule = css.front() == '@';
    const std::size_t head_end = find_outside(css, at_rule ? "{;" : "{");
    const std::string_view head = without_blanks(css.substr(0, head_end));
    const bool has_block = head_end < css.size() && css[head_end] == '{';
    css = rest_of(css, head_end + 1);
    std::string_view block;
    if (has_block) {
      const std::size_t end = block_end(css);
      block = css.substr(0, end);
      css = rest_of(css, end + 1);
    }
    if (!at_rule) {
      if (!has_block) break;
      if (find_outside(block, "{") < block.size()) events.not_followed("a rule inside another one");
      else events.rule(head, block);
      continue;
    }
    const std::string_view name = head.substr(0, std::min(head.find_first_of(" \t\r\n("), head.size()));
    if (same_word(name, "@media")) {
      const MediaMatch match = match_media(head.substr(name.size()));
      if (match == MediaMatch::unknown || (match == MediaMatch::yes && nested == max_nested_blocks))
        events.not_followed("@media");
      else if (match == MediaMatch::yes) read_rules(block, events, nested + 1);
      continue;
    }
    // Fonts, encodings and pages change no line.
    constexpr std::string_view harmless[] = {"@charset", "@namespace", "@font-face", "@page", "@counter-style"};
    if (std::none_of(std::begin(harmless), std::end(harmless), [&](std::string_view h) { return same_word(name, h); }))
      events.not_followed(name);
  }
}

}  // namespace

std::string without_css_comments(std::string_view css) {
  std::string plain;
  plain.reserve(css.size());
  for (std::size_t at = 0; at < css.size();) {
    const char c = css[at];
    if (css.substr(at, 2) == "/*") {
      const std::size_t end = css.find("*/", at + 2);
      at = end == std::string_view::npos ? css.size() : end + 2;
      plain += ' ';
    } else if (css.substr(at, 4) == "<!--") {
      at += 4;
    } else if (css.substr(at, 3) == "-->") {
      at += 3;
    } else if (c == '"' || c == '\'') {
      const std::size_t end = string_end(css, at);
      plain += css.substr(at, end - at);
      at = end;
    } else {
      plain += c;
      ++at;
    }
  }
  return plain;
}

void read_css_declarations(std::string_view block, const std::function<void(const CssDeclaration&)>& take) {
  while (!block.empty()) {
    const std::size_t end = find_outside(block, ";");
    const std::string_view one = block.substr(0, end);
    block = rest_of(block, end + 1);
    const std::size_t colon = one.find(':');
    if (colon == std::string_view::npos) continue;
    CssDeclaration declaration{without_blanks(one.substr(0, colon)), without_blanks(one.substr(colon + 1)), false};
    const std::size_t mark = declaration.value.rfind('!');
    if (mark != std::string_view::npos && same_word(without_blanks(declaration.value.substr(mark + 1)), "important")) {
      declaration.value = without_blanks(declaration.value.substr(0, mark));
      declaration.important = true;
    }
    if (!declaration.value.empty()) take(declaration);
  }
}

void read_css_sheet(std::string_view css, const CssSheetEvents& events) { read_rules(css, events, 0); }

MediaMatch match_media(std::string_view query) {
  MediaMatch match = without_blanks(query).empty() ? MediaMatch::yes : MediaMatch::no;
  while (!query.empty()) {
    const std::size_t comma = find_outside(query, ",");
    std::string_view one = without_blanks(query.substr(0, comma));
    query = rest_of(query, comma + 1);
    if (one.size() > 5 && same_word(one.substr(0, 5), "only ")) one = without_blanks(one.substr(5));
    if (one.empty()) continue;
    if (same_word(one, "all") || same_word(one, "screen")) return MediaMatch::yes;
    if (one.find_first_of("( \t\r\n") != std::string_view::npos) match = MediaMatch::unknown;
  }
  return match;
}

}  // namespace formwright
