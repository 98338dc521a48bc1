// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What is seen through a tile's part of the picture, as heights over the tile along the rays from the viewpoint.
#include "base/context.h"
#include "relief/tiles/relief_tile.h"

namespace formwright {

/// Columns run upwards, and every column reaches from the lower to the upper edge of the tile, so that the outermost
/// nodes lie exactly on its outline.
struct TileGrid {
  std::vector<double> x_mm, low_mm, high_mm;  // of each column: where it stands, and its two ends
  int rows = 0;
  std::vector<double> height_mm;  // rows * columns, along the tile's normal; 0 where the model is not seen

  int columns() const { return static_cast<int>(x_mm.size()); }
  std::size_t node(int column, int row) const {
    return static_cast<std::size_t>(row) * x_mm.size() + static_cast<std::size_t>(column);
  }
  Vec2 place(int column, int row) const {
    const auto c = static_cast<std::size_t>(column);
    return {x_mm[c], low_mm[c] + (high_mm[c] - low_mm[c]) * row / (rows - 1)};
  }
  /// A corner of the outline, which no larger triangle may cut off.
  bool is_corner(int column, int row) const {
    const auto c = static_cast<std::size_t>(column);
    return (row == 0 && low_corner[c] != 0) || (row == rows - 1 && high_corner[c] != 0);
  }
  std::vector<char> low_corner, high_corner;  // of each column, whether that end is a corner
};

/// How far the relief may stand before the tile and be carved into it, along its normal.
struct TileRoom {
  double above_mm = 0, below_mm = 0;
};

/// `surface`: of the tile's band alone, in mm, as to_scene has it; may be empty. Rays are cast at it, and heights are
/// kept within `room`. Neighbouring nodes are at most `pixel_mm` apart on the tile.
/// Throws Error: invalid_input "pixel_mm" (over 16 million nodes), cancelled.
TileGrid tile_grid(const ReliefTile& tile, const TriangleMesh& surface, const TileRoom& room, double pixel_mm,
                   const Context& context);

}  // namespace formwright
