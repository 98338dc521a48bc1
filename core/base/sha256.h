// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// FIPS 180-4, in the core because WASM has no crypto library to link.
#include <array>
#include <cstdint>
#include <string>

#include "base/bytes.h"

namespace formwright {
/// 64 lower-case hexadecimal digits.
std::string sha256_hex(ByteView bytes);

/// The same of bytes that arrive in pieces.
class Sha256 {
 public:
  void add(ByteView bytes);
  /// Of all that was added; nothing may be added after it.
  std::string hex();

 private:
  std::array<std::uint32_t, 8> state_ = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                         0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<unsigned char, 64> block_{};  // of the bytes that do not fill one yet
  std::uint64_t bytes_ = 0;
};
}  // namespace formwright
