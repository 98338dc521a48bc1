// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What no reader lets through.
#include <cmath>
#include <limits>
#include <string>

#include "formats/shared/mesh_source.h"

namespace formwright {

// Squares and products of lengths must stay finite in everything that follows; 1e15 mm are 1000 million km.
inline constexpr double largest_coordinate = 1e15;

inline bool is_sane_coordinate(double value) { return std::abs(value) <= largest_coordinate; }  // false for NaN

/// "coordinate of vertex 12 is not a number; export the model again."
inline std::string insane_coordinate(std::string_view what, std::int64_t number, double value) {
  return "a coordinate of " + std::string(what) + ' ' + std::to_string(number) +
         (std::isnan(value)   ? " is not a number (NaN)"
          : std::isinf(value) ? " is infinite"
                              : " is beyond any real size (over 1e15)") +
         "; repair the model where it was made and export it again.";
}

/// Vertices are numbered with 32 bits.
inline void check_vertex_count(const MeshSource& source, std::int64_t count) {
  if (count > std::numeric_limits<int>::max() / 3)
    source.refuse("it holds " + counted(count, "vertex", "vertices") +
                  ", more than can be numbered; simplify the mesh first.");
}

}  // namespace formwright
