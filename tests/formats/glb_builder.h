// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// GLB and zip containers written by hand, so that readers are tested against something other than our writers.
#include <string>

#include "formats/shared/byte_order.h"

namespace formwright::test {

inline Bytes make_glb(std::string json, const Bytes& binary) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  Bytes bytes;
  const auto word = [&](std::size_t value) { append(bytes, static_cast<std::uint32_t>(value)); };
  word(0x46546C67), word(2), word(28 + json.size() + binary.size());
  word(json.size()), word(0x4E4F534A);
  for (const char c : json) bytes.push_back(static_cast<std::byte>(c));
  word(binary.size()), word(0x004E4942);
  bytes.insert(bytes.end(), binary.begin(), binary.end());
  return bytes;
}

/// Numbers one after the other, as bytes.
template <class... Number>
void put(Bytes& bytes, Number... values) {
  (append(bytes, values), ...);
}

inline std::string base64(const Bytes& bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = (bits << 8) | (i + k < bytes.size() ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0);
    for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? digits[(bits >> (18 - 6 * k)) & 63] : '=';
  }
  return text;
}

}  // namespace formwright::test
