// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// One piece of a relief on a grid over its part of a pillar's surface: columns along the outline, rows along the
// height. Every node is a ray from the viewpoint through a point of the surface.
#include <span>

#include "relief/forest/pieces/forest_relief.h"
#include "relief/forest/plan/wall_reach.h"

namespace formwright {

struct PieceGridSizes {
  double pixel_mm = 0.3;          // spacing of columns and rows on the surface, at most
  double border_inset_mm = 0.01;  // what is left out at the piece's ends, so that thin solids close in any file format
};

struct PieceGrid {
  int pillar = 0, piece = 0;
  std::vector<double> aside;     // tangent of each column, ascending
  std::vector<WallReach> reach;  // of each column
  std::vector<double> z_mm;      // of each row on the surface
  std::vector<double> front;     // rows * columns: distance ahead of the relief, or of the surface where there is none
  std::vector<char> covered;     // (rows - 1) * (columns - 1): cells in whose middle the model is seen
  std::vector<double> middle_front;  // the same: of the relief there

  int columns() const { return static_cast<int>(aside.size()); }
  int rows() const { return static_cast<int>(z_mm.size()); }
  std::size_t node(int column, int row) const {
    return static_cast<std::size_t>(row) * aside.size() + static_cast<std::size_t>(column);
  }
  std::size_t cell(int column, int row) const {
    return static_cast<std::size_t>(row) * (aside.size() - 1) + static_cast<std::size_t>(column);
  }
  bool any_covered() const;
};

/// Of (rows - 1) * (columns - 1) cells: where two covered ones touch at a node crosswise, one is left out, until there
/// are none, because no printed solid may touch itself along a line.
void part_crosswise_cells(std::vector<char>& covered, int columns, int rows);

/// How many nodes a grid would have.
double node_count(const PlanView& plan, const Pillar& pillar, const WallPiece& piece, const PieceGridSizes& sizes);

/// Rays are cast at `relief.surface`, and what they meet is kept within `space` at every node and its neighbours. Where
/// nothing is carved, the relief stands before the surface by a twentieth of a millimetre at least, so that it is a
/// part of the solid; where there is no space for that, it is left out. Throws Error: cancelled.
PieceGrid piece_grid(const ForestRelief& relief, int piece, const ForestView& view, const ReliefSpace& space,
                     const PieceGridSizes& sizes, const Context& context);

}  // namespace formwright
