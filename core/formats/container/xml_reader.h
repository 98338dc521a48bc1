// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// XML as a stream of tags, read by Expat. A 3MF of a million triangles holds 1.5 million elements: a tree of them takes
// several times the text's memory, this takes none. Document types are refused, so there are no entities to expand;
// namespaces' prefixes are cut off.
#include <memory>
#include <string>
#include <string_view>

#include "formats/shared/mesh_source.h"

namespace formwright {

class XmlReader {
 public:
  enum class Tag { start, end };

  /// `source`'s bytes must outlive the reader. Throws Error{invalid_input} for UTF-16.
  explicit XmlReader(const MeshSource& source);
  ~XmlReader();
  XmlReader(const XmlReader&) = delete;
  XmlReader& operator=(const XmlReader&) = delete;

  /// Goes to the next tag; an empty element gives a start and an end. False after the root's end.
  /// Throws Error{invalid_input} with the line for anything that is not well formed.
  bool next();

  Tag tag() const;
  /// Local name: "model", "colorgroup" for <m:colorgroup>.
  std::string_view name() const;
  std::size_t depth() const { return depth_; }

  /// Of the start tag, by local name, entities replaced; "" if absent. Valid until the next tag.
  std::string_view attribute(std::string_view name) const;
  bool has(std::string_view name) const;
  /// The same as clean text of at most 1000 bytes, to be shown.
  std::string text_attribute(std::string_view name) const;

  /// Refuses the file with the current tag's line.
  [[noreturn]] void refuse(const std::string& what) const;

 private:
  struct Expat;
  const MeshSource& source_;
  std::unique_ptr<Expat> expat_;
  std::size_t depth_ = 0;
};

}  // namespace formwright
