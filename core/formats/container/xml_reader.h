// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// XML as a stream of tags. A 3MF of a million triangles holds 1.5 million elements: pugixml's tree of them takes
// several times the text's memory, this takes none. No document types, so no entities to expand; namespaces' prefixes
// are cut off.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "formats/shared/mesh_source.h"

namespace formwright {

class XmlReader {
 public:
  enum class Tag { start, end };

  /// Views into `source`'s bytes, which must outlive the reader. Throws Error{invalid_input} for UTF-16.
  explicit XmlReader(const MeshSource& source);

  /// Goes to the next tag; an empty element gives a start and an end. False after the root's end.
  /// Throws Error{invalid_input} with the line for anything that is not well formed.
  bool next();

  Tag tag() const { return tag_; }
  /// Local name: "model", "colorgroup" for <m:colorgroup>.
  std::string_view name() const { return name_; }
  std::size_t depth() const { return open_.size(); }

  /// Of the start tag, by local name, entities not yet replaced; "" if absent.
  std::string_view attribute(std::string_view name) const;
  bool has(std::string_view name) const;
  /// The same with the five entities and character references replaced.
  std::string text_attribute(std::string_view name) const;

  /// Refuses the file with the current tag's line.
  [[noreturn]] void refuse(const std::string& what) const;

 private:
  struct Attribute {
    std::string_view name, value;
  };
  void read_start_tag();
  void read_end_tag();
  void skip_past(std::string_view terminator);
  std::string_view read_name();

  const MeshSource& source_;
  std::string_view text_;
  std::size_t at_ = 0, tag_at_ = 0;
  Tag tag_ = Tag::start;
  std::string_view name_;
  std::vector<Attribute> attributes_;
  std::vector<std::string_view> open_;  // full names
  bool empty_element_ = false, closed_ = false;
};

}  // namespace formwright
