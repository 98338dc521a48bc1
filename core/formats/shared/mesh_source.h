// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What every reader is given, and how all readers refuse a file.
#include <string>
#include <string_view>

#include "base/context.h"
#include "formats/shared/model_file.h"

namespace formwright {

/// `text` as valid UTF-8 of one line: bytes that are not UTF-8 are taken for Latin-1, control characters go.
std::string clean_text(std::string_view text, std::size_t max_bytes = 200);

/// Part after the last / or \, in lower case (ASCII): how companions are compared.
std::string bare_name(std::string_view path);

/// "1 vertex", "2 vertices", "20 000 000 triangles".
std::string counted(std::int64_t count, std::string_view one, std::string_view many);

class MeshSource {
 public:
  MeshSource(ByteView bytes, std::string_view file_name, const ReadOptions& options, Context& context);

  ByteView bytes() const { return bytes_; }
  std::string_view text() const { return as_text(bytes_); }
  const std::string& name() const { return name_; }
  const ReadOptions& options() const { return options_; }
  Context& context() const { return context_; }

  /// Throws Error{invalid_input, where}: "bunny.obj: <what>". `what` goes on in lower case, names the fix, ends in
  /// ".".
  [[noreturn]] void refuse(const std::string& what) const;
  /// The same with the number of the line in which byte `offset` stands: "bunny.obj, line 12: <what>".
  [[noreturn]] void refuse_line(std::size_t offset, const std::string& what) const;
  /// Refuses a file with more triangles than the options allow.
  void check_triangle_count(std::int64_t count) const;
  /// Refuses a file without triangles; `instead` says what it does hold ("a point cloud"), or is empty.
  [[noreturn]] void refuse_empty(const std::string& instead) const;

 private:
  ByteView bytes_;
  std::string name_;
  const ReadOptions& options_;
  Context& context_;
};

}  // namespace formwright
