// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>

namespace formwright {
/// A place in a std::vector, from a number of a vertex, face or matrix row: those are int.
inline std::size_t index(int number) { return static_cast<std::size_t>(number); }
}  // namespace formwright
