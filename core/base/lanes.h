// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Four numbers at a time, with the vector types that GCC and Clang share: SSE and AVX natively, SIMD128
// in WebAssembly, plain code elsewhere. Templates over `Lane` take Double4 or a plain double, one lane wide.
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace formwright {

using Float4 = float __attribute__((vector_size(16)));
using Double4 = double __attribute__((vector_size(32)));

// By reference: passing 32-byte vectors by value depends on AVX.
inline Float4 lesser(const Float4& a, const Float4& b) { return a < b ? a : b; }
inline Float4 greater(const Float4& a, const Float4& b) { return a > b ? a : b; }

/// Bit i is set where lane i of a comparison holds.
template <class Mask>
unsigned lanes_set(const Mask& mask) {
  if constexpr (std::is_arithmetic_v<Mask>) return mask ? 1 : 0;
  else return static_cast<unsigned>((mask[0] & 1) | (mask[1] & 2) | (mask[2] & 4) | (mask[3] & 8));
}

inline double get_lane(double value, std::size_t) { return value; }
inline double get_lane(const Double4& value, std::size_t lane) { return value[lane]; }
inline void set_lane(double& value, std::size_t, double number) { value = number; }
inline void set_lane(Double4& value, std::size_t lane, double number) { value[lane] = number; }

}  // namespace formwright
