// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The parts of a GLB file: numbers go into one binary chunk, with views and accessors that say where and what they are.
#include <algorithm>
#include <limits>
#include <string>

#include "base/data/json.h"
#include "formats/shared/byte_order.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

class GlbAssembly {
 public:
  enum class Target { none = 0, vertices = 34962, indices = 34963 };

  /// `where`, `too_large`: of the Error{invalid_input} when the file would exceed the 4 GB of its format.
  GlbAssembly(std::string where, std::string too_large) : where_(std::move(where)), too_large_(std::move(too_large)) {}

  /// An accessor of count x components floats, value(i, k); `shape` is glTF's word for it. With `bounds`, of the
  /// numbers as stored, which positions and times need.
  template <class Value>
  int add_floats(std::size_t count, int components, const char* shape, bool bounds, Target target, const Value& value) {
    const std::size_t bytes = 4 * count * static_cast<std::size_t>(components);
    const int view = add_view(bytes, target);
    std::byte* at = binary_.data() + (binary_.size() - bytes);
    std::vector<float> low(static_cast<std::size_t>(components), std::numeric_limits<float>::max()),
        high(low.size(), std::numeric_limits<float>::lowest());
    for (std::size_t i = 0; i < count; ++i)
      for (int k = 0; k < components; ++k, at += 4) {
        const auto number = static_cast<float>(value(static_cast<Eigen::Index>(i), k));
        store(at, number);
        low[static_cast<std::size_t>(k)] = std::min(low[static_cast<std::size_t>(k)], number);
        high[static_cast<std::size_t>(k)] = std::max(high[static_cast<std::size_t>(k)], number);
      }
    const int accessor = add_accessor(view, 5126, count, shape);
    if (bounds) accessors_.back()["min"] = low, accessors_.back()["max"] = high;
    return accessor;
  }

  /// An accessor of `count` indices, index(i), of 16 bits where `vertices` allow it.
  template <class Index>
  int add_indices(std::size_t count, std::size_t vertices, const Index& index) {
    const bool small = vertices <= 65535;  // 65535 itself is reserved
    const std::size_t width = small ? 2 : 4;
    const int view = add_view(count * width, Target::indices);
    std::byte* at = binary_.data() + (binary_.size() - count * width);
    for (std::size_t i = 0; i < count; ++i, at += width) {
      if (small) store(at, static_cast<std::uint16_t>(index(i)));
      else store(at, static_cast<std::uint32_t>(index(i)));
    }
    return add_accessor(view, small ? 5123 : 5125, count, "SCALAR");
  }

  /// A view of bytes as they are: pictures.
  int add_bytes(ByteView bytes);

  /// The file: `json` with what was added.
  Bytes finish(Json json);

 private:
  /// Begins at a multiple of 4 bytes, as every type of accessor needs.
  int add_view(std::size_t bytes, Target target);
  int add_accessor(int view, int type, std::size_t count, const char* shape);

  std::string where_, too_large_;
  Json views_ = Json::array(), accessors_ = Json::array();
  Bytes binary_;
};

}  // namespace formwright
