// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Numbers in binary files, at any alignment, in either byte order. All our hosts are little endian.
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "base/bytes.h"

namespace formwright {

static_assert(std::endian::native == std::endian::little, "reading and writing would need to swap bytes");

template <class Number>
Number load(const std::byte* from) {
  Number value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

template <class Number>
Number load_swapped(const std::byte* from) {
  std::array<std::byte, sizeof(Number)> bytes;
  std::reverse_copy(from, from + sizeof(Number), bytes.begin());
  return std::bit_cast<Number>(bytes);
}

template <class Number>
void store(std::byte* to, Number value) {
  std::memcpy(to, &value, sizeof value);
}

template <class Number>
void append(Bytes& bytes, Number value) {
  const auto raw = std::bit_cast<std::array<std::byte, sizeof(Number)>>(value);
  bytes.insert(bytes.end(), raw.begin(), raw.end());
}

}  // namespace formwright
