// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// glTF accessors: typed, strided, normalised and sparse numbers in buffers.
#include "formats/glb/glb_scene.h"

namespace formwright {

class GltfAccessor {
 public:
  /// Checks that every element lies within its buffer view. Throws Error{invalid_input}.
  GltfAccessor(const GltfDocument& document, std::int64_t index);
  GltfAccessor(GltfAccessor&&) = default;
  GltfAccessor(const GltfAccessor&) = delete;

  std::int64_t count() const { return count_; }
  int components() const { return components_; }
  bool is_unsigned_integer() const { return type_ == 5121 || type_ == 5123 || type_ == 5125; }

  /// One number; normalised integers as 0 to 1 or -1 to 1.
  double number(std::int64_t element, int component) const;
  /// One number of an accessor of unsigned integers.
  std::uint32_t index(std::int64_t element) const;

 private:
  const std::byte* place(std::int64_t element, int component) const;
  void apply_sparse(const GltfDocument& document, const GltfDocument::Object& sparse, std::int64_t index);

  std::int64_t count_ = 0;
  int components_ = 0, type_ = 0;
  bool normalised_ = false;
  const std::byte* data_ = nullptr;  // nullptr: all zero
  std::size_t stride_ = 0, component_bytes_ = 0;
};

}  // namespace formwright
