// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <utility>

#include "formats/ply/ply.h"
#include "formats/shared/text_scan.h"

namespace formwright {
namespace {

constexpr std::array<std::pair<std::string_view, PlyType>, 16> type_names{{{"char", PlyType::int8},
                                                                           {"uchar", PlyType::uint8},
                                                                           {"short", PlyType::int16},
                                                                           {"ushort", PlyType::uint16},
                                                                           {"int", PlyType::int32},
                                                                           {"uint", PlyType::uint32},
                                                                           {"float", PlyType::float32},
                                                                           {"double", PlyType::float64},
                                                                           {"int8", PlyType::int8},
                                                                           {"uint8", PlyType::uint8},
                                                                           {"int16", PlyType::int16},
                                                                           {"uint16", PlyType::uint16},
                                                                           {"int32", PlyType::int32},
                                                                           {"uint32", PlyType::uint32},
                                                                           {"float32", PlyType::float32},
                                                                           {"float64", PlyType::float64}}};

class HeaderReader {
 public:
  explicit HeaderReader(const MeshSource& source) : source_(source), text_(source.text()) {}

  PlyHeader read() {
    next_line();  // "ply", as the format was found by it
    bool has_format = false;
    while (next_line()) {
      TextScan scan(line_);
      const std::string_view keyword = scan.word();
      if (keyword == "end_header") {
        if (!has_format) refuse("the header has no “format” line; export it again.");
        header_.body = at_;
        check_sizes();
        return std::move(header_);
      }
      if (keyword == "format") has_format = format(scan);
      else if (keyword == "element") element(scan);
      else if (keyword == "property") property(scan);
      else if (keyword == "comment" || keyword == "obj_info") comment(scan);
      else if (!keyword.empty())
        refuse("“" + clean_text(keyword, 40) + "” is not a word of a PLY header; export it again.");
    }
    source_.refuse("its header has no end (“end_header”); export it or copy it again.");
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const { source_.refuse_line(line_at_, what); }

  /// Lines end in \n, \r\n or \r. What ends the first line ends all: after a lone \r the body may begin with \n.
  bool next_line() {
    if (at_ >= text_.size()) return false;
    line_at_ = at_;
    const std::size_t stop = text_.find_first_of("\r\n", at_);
    if (stop == std::string_view::npos) return false;
    line_ = text_.substr(at_, stop - at_);
    at_ = stop + 1;
    const bool pair = text_[stop] == '\r' && at_ < text_.size() && text_[at_] == '\n';
    if (line_at_ == 0) pairs_ = pair;
    if (pairs_ && pair) ++at_;
    return true;
  }

  PlyType type(std::string_view word) const {
    for (const auto& [name, type] : type_names)
      if (name == word) return type;
    refuse("“" + clean_text(word, 40) + "” is not a type of number in PLY; export it again.");
  }

  bool format(TextScan& scan) {
    const std::string_view name = scan.word();
    if (name == "ascii") header_.encoding = PlyHeader::Encoding::ascii;
    else if (name == "binary_little_endian") header_.encoding = PlyHeader::Encoding::little_endian;
    else if (name == "binary_big_endian") header_.encoding = PlyHeader::Encoding::big_endian;
    else refuse("“" + clean_text(name, 40) + "” is not a format of PLY; export it again.");
    return true;
  }

  void element(TextScan& scan) {
    PlyElement element;
    element.name = scan.word();
    scan.skip_blanks();
    if (element.name.empty() || !scan.integer(element.count) || element.count < 0 || !trimmed(scan.rest()).empty())
      refuse("an element needs a name and a count; export it again.");
    if (header_.element(element.name) != nullptr)
      refuse("the element “" + clean_text(element.name, 40) + "” is declared twice; export it again.");
    // Thousands of elements would make this search slow; nobody has them.
    if (header_.elements.size() >= 1000) refuse("it declares more than 1000 elements; export it with fewer.");
    header_.elements.push_back(std::move(element));
  }

  void property(TextScan& scan) {
    if (header_.elements.empty()) refuse("a property comes before any element; export it again.");
    PlyProperty property;
    std::string_view word = scan.word();
    if (word == "list") {
      property.count_type = type(scan.word());
      if (*property.count_type == PlyType::float32 || *property.count_type == PlyType::float64)
        refuse("the length of a list cannot be a fraction; export it again.");
      word = scan.word();
    }
    property.type = type(word);
    property.name = clean_text(scan.word());
    if (property.name.empty()) refuse("a property has no name; export it again.");
    auto& properties = header_.elements.back().properties;
    // Thousands of properties would make this search slow; nobody has them.
    if (properties.size() >= 1000) refuse("an element has more than 1000 properties; export it with fewer.");
    if (std::ranges::any_of(properties, [&](const PlyProperty& p) { return p.name == property.name; }))
      refuse("the property “" + clean_text(property.name, 40) + "” is declared twice; export it again.");
    properties.push_back(std::move(property));
  }

  void comment(TextScan& scan) {
    if (equal_ignoring_case(scan.word(), "TextureFile") && !trimmed(scan.rest()).empty())
      header_.textures.push_back(clean_text(trimmed(scan.rest()), 1000));
  }

  /// A header of 100 bytes can declare 4 billion vertices: nothing is allocated that the file cannot fill.
  void check_sizes() const {
    const bool ascii = header_.encoding == PlyHeader::Encoding::ascii;
    const auto left = static_cast<double>(text_.size() - header_.body);
    double minimum = ascii ? -1 : 0;  // the last number of a text needs no blank after it
    for (const PlyElement& element : header_.elements) {
      double row = 0;
      for (const PlyProperty& property : element.properties)
        row += ascii ? 2 : static_cast<double>(size_of(property.count_type.value_or(property.type)));
      minimum += row * static_cast<double>(element.count);
      if (minimum > left)
        source_.refuse("it declares " + counted(element.count, "row", "rows") + " of “" + clean_text(element.name, 40) +
                       "”, more than it holds; export it or copy it again.");
    }
  }

  const MeshSource& source_;
  std::string_view text_, line_;
  std::size_t at_ = 0, line_at_ = 0;
  bool pairs_ = false;
  PlyHeader header_;
};

}  // namespace

std::size_t size_of(PlyType type) {
  switch (type) {
    case PlyType::int8:
    case PlyType::uint8: return 1;
    case PlyType::int16:
    case PlyType::uint16: return 2;
    case PlyType::int32:
    case PlyType::uint32:
    case PlyType::float32: return 4;
    case PlyType::float64: return 8;
  }
  return 0;
}

const PlyElement* PlyHeader::element(std::string_view name) const {
  const auto found = std::ranges::find(elements, name, &PlyElement::name);
  return found == elements.end() ? nullptr : &*found;
}

PlyHeader read_ply_header(const MeshSource& source) { return HeaderReader(source).read(); }

}  // namespace formwright
