// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/container/xml_reader.h"

#include <algorithm>
#include <array>
#include <charconv>

#include "formats/shared/text_scan.h"

namespace formwright {
namespace {

// 3MF nests six deep and gives a tag a dozen attributes.
constexpr std::size_t max_depth = 256, max_attributes = 256;

std::string_view local(std::string_view name) { return name.substr(name.find(':') + 1); }  // npos + 1 = 0

void append_utf8(std::string& text, std::uint32_t code) {
  const auto put = [&](std::uint32_t byte) { text.push_back(static_cast<char>(byte)); };
  if (code < 0x80) put(code);
  else if (code < 0x800) put(0xC0 | code >> 6), put(0x80 | (code & 0x3F));
  else if (code < 0x10000) put(0xE0 | code >> 12), put(0x80 | (code >> 6 & 0x3F)), put(0x80 | (code & 0x3F));
  else
    put(0xF0 | code >> 18), put(0x80 | (code >> 12 & 0x3F)), put(0x80 | (code >> 6 & 0x3F)), put(0x80 | (code & 0x3F));
}

}  // namespace

XmlReader::XmlReader(const MeshSource& source) : source_(source), text_(source.text()) {
  if (text_.starts_with("\xfe\xff") || text_.starts_with("\xff\xfe"))
    source.refuse("its XML is in UTF-16; export it in UTF-8.");
}

void XmlReader::refuse(const std::string& what) const { source_.refuse_line(tag_at_, what); }

bool XmlReader::next() {
  if (empty_element_) {
    empty_element_ = false;
    tag_ = Tag::end;
    open_.pop_back();
    closed_ = open_.empty();
    return true;
  }
  while (true) {
    if (closed_) return false;  // what comes after the root does not matter
    const std::size_t open = text_.find('<', at_);
    if (open == std::string_view::npos) source_.refuse("its XML ends too early; export it or copy it again.");
    tag_at_ = open;
    at_ = open + 1;
    const std::string_view rest = text_.substr(at_);
    if (rest.starts_with("!--")) at_ += 3, skip_past("-->");
    else if (rest.starts_with("![CDATA[")) skip_past("]]>");
    else if (rest.starts_with('?')) skip_past("?>");
    else if (rest.starts_with('!')) refuse("its XML has a document type, which 3MF forbids; export it again.");
    else if (rest.starts_with('/')) return read_end_tag(), true;
    else return read_start_tag(), true;
  }
}

void XmlReader::skip_past(std::string_view terminator) {
  const std::size_t found = text_.find(terminator, at_);
  if (found == std::string_view::npos) source_.refuse("its XML ends too early; export it or copy it again.");
  at_ = found + terminator.size();
}

std::string_view XmlReader::read_name() {
  const std::size_t from = at_;
  const auto ends = [](char c) {
    return is_space(c) || c == '=' || c == '/' || c == '>' || c == '<' || c == '"' || c == '\'';
  };
  while (at_ < text_.size() && !ends(text_[at_])) ++at_;
  if (at_ == from) refuse("its XML is damaged; export it or copy it again.");
  return text_.substr(from, at_ - from);
}

void XmlReader::read_end_tag() {
  ++at_;
  const std::string_view name = read_name();
  while (at_ < text_.size() && is_space(text_[at_])) ++at_;
  if (at_ == text_.size() || text_[at_] != '>' || open_.empty() || open_.back() != name)
    refuse("the end of “" + clean_text(name, 40) + "” does not match its beginning; export it or copy it again.");
  ++at_;
  tag_ = Tag::end;
  name_ = local(name);
  open_.pop_back();
  closed_ = open_.empty();
}

void XmlReader::read_start_tag() {
  tag_ = Tag::start;
  attributes_.clear();
  const std::string_view name = read_name();
  name_ = local(name);
  while (true) {
    while (at_ < text_.size() && is_space(text_[at_])) ++at_;
    if (at_ == text_.size()) source_.refuse("its XML ends too early; export it or copy it again.");
    if (text_[at_] == '>') {
      ++at_;
      break;
    }
    if (text_[at_] == '/' && text_.substr(at_ + 1).starts_with('>')) {
      at_ += 2;
      empty_element_ = true;
      break;
    }
    const std::string_view attribute = read_name();
    while (at_ < text_.size() && is_space(text_[at_])) ++at_;
    if (at_ == text_.size() || text_[at_] != '=') refuse("its XML is damaged; export it or copy it again.");
    ++at_;
    while (at_ < text_.size() && is_space(text_[at_])) ++at_;
    if (at_ == text_.size() || (text_[at_] != '"' && text_[at_] != '\''))
      refuse("its XML is damaged; export it or copy it again.");
    const std::size_t from = at_ + 1, stop = text_.find(text_[at_], from);
    if (stop == std::string_view::npos) source_.refuse("its XML ends too early; export it or copy it again.");
    if (attributes_.size() >= max_attributes) refuse("a tag has more than 256 attributes; export it again.");
    attributes_.push_back({local(attribute), text_.substr(from, stop - from)});
    at_ = stop + 1;
  }
  if (open_.size() >= max_depth) refuse("its XML is nested more than 256 deep; export it again.");
  open_.push_back(name);
}

std::string_view XmlReader::attribute(std::string_view name) const {
  for (const Attribute& attribute : attributes_)
    if (attribute.name == name) return attribute.value;
  return {};
}

bool XmlReader::has(std::string_view name) const {
  return std::ranges::any_of(attributes_, [&](const Attribute& attribute) { return attribute.name == name; });
}

std::string XmlReader::text_attribute(std::string_view name) const {
  constexpr std::array<std::pair<std::string_view, char>, 5> entities{
      {{"lt", '<'}, {"gt", '>'}, {"amp", '&'}, {"quot", '"'}, {"apos", '\''}}};
  std::string text;
  std::string_view value = attribute(name);
  while (!value.empty()) {
    const std::size_t stop = value.front() == '&' ? value.substr(0, 12).find(';') : std::string_view::npos;
    if (stop == std::string_view::npos) {
      const std::size_t plain = std::min(value.find('&', 1), value.size());
      text.append(value.substr(0, plain));
      value.remove_prefix(plain);
      continue;
    }
    const std::string_view entity = value.substr(1, stop - 1);
    value.remove_prefix(stop + 1);
    for (const auto& [known, character] : entities)
      if (entity == known) text.push_back(character);
    if (entity.starts_with('#')) {
      const bool hexadecimal = entity.substr(1).starts_with('x');
      const std::string_view digits = entity.substr(hexadecimal ? 2 : 1);
      std::uint32_t code = 0;
      std::from_chars(digits.data(), digits.data() + digits.size(), code, hexadecimal ? 16 : 10);
      if (code > 0 && code < 0x110000) append_utf8(text, code);
    }
  }
  return clean_text(text, 1000);
}

}  // namespace formwright
