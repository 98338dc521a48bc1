// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Files in memory: the core reads and writes bytes, hosts touch disks.
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace formwright {

using Bytes = std::vector<std::byte>;
using ByteView = std::span<const std::byte>;

inline std::string_view as_text(ByteView bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }
inline ByteView as_bytes(std::string_view text) {
  return {reinterpret_cast<const std::byte*>(text.data()), text.size()};
}
inline Bytes to_bytes(std::string_view text) {
  const ByteView view = as_bytes(text);
  return {view.begin(), view.end()};
}

}  // namespace formwright
