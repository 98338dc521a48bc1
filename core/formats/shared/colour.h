// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// sRGB (IEC 61966-2-1), which OBJ, MTL, PLY and 3MF colours are in, and linear light, which a Model holds.
#include <algorithm>
#include <cmath>
#include <cstdint>

namespace formwright {

inline double linear_of_srgb(double c) {
  c = std::clamp(c, 0.0, 1.0);
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

inline double srgb_of_linear(double c) {
  c = std::clamp(c, 0.0, 1.0);
  return c <= 0.0031308 ? c * 12.92 : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
}

/// Nearest of 256 steps.
inline std::uint8_t byte_of_unit(double c) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(c, 0.0, 1.0) * 255));
}

}  // namespace formwright
