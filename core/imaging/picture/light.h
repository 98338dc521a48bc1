// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// sRGB bytes and linear light of 16 bits, by tables: the smallest step of sRGB is 20 of these levels.
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "formats/shared/colour.h"

namespace formwright {

inline constexpr double light_levels = 65535;

/// Linear light of an sRGB byte, 0 to 65535.
inline const std::array<std::uint16_t, 256>& light_of_byte() {
  static const std::array<std::uint16_t, 256> table = [] {
    std::array<std::uint16_t, 256> t{};
    for (std::size_t i = 0; i < t.size(); ++i)
      t[i] = static_cast<std::uint16_t>(std::lround(linear_of_srgb(static_cast<double>(i) / 255) * light_levels));
    return t;
  }();
  return table;
}

/// Nearest sRGB byte of each level of linear light.
inline const std::vector<std::uint8_t>& byte_of_light() {
  static const std::vector<std::uint8_t> table = [] {
    std::vector<std::uint8_t> t(65536);
    for (std::size_t i = 0; i < t.size(); ++i)
      t[i] = byte_of_unit(srgb_of_linear(static_cast<double>(i) / light_levels));
    return t;
  }();
  return table;
}

}  // namespace formwright
