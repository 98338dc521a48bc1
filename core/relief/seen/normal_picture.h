// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a viewer at the viewpoint could see of a surface, before any light falls on it: one normal a pixel.
#include <vector>

#include "base/context.h"
#include "relief/view/view_frame.h"

namespace formwright {

/// A regular grid of pixels over the model as it is seen on the plate; pixel (0, 0) is at the lower left.
struct PictureGrid {
  int columns = 0, rows = 0;
  double pixel = 0;                  // side of a pixel, of the model's seen width
  double arc_minutes_per_pixel = 0;  // at the middle of the picture
};

/// Pixels of one arc minute, which the eye just resolves, from the viewing distance. A far view has no distance: it is
/// looked at from where its width fills 20 degrees, about three widths away. Pixels are larger where the picture would
/// have more than four million of them, and smaller where fewer than 100 would lie across it.
PictureGrid eye_grid(const ViewFrame& frame);
/// The same grid with pixels `factor` times as large, under the same limits.
PictureGrid eye_grid(const ViewFrame& frame, double factor);

struct NormalPicture {
  PictureGrid grid;
  std::vector<float> x, y, z;  // rows * columns: unit normals (right, up, towards the viewer); 0 where nothing is seen
  std::vector<char> covered;   // 1 where the surface is seen

  std::size_t at(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(grid.columns) + static_cast<std::size_t>(column);
  }
};

/// Draws the nearest face at the middle of every pixel. Normals are area-weighted vertex normals interpolated over the
/// face, as smooth shading shows them; those of faces turned away from the viewer are turned round.
/// `positions`: n x 3, view coordinates, all in front of the viewpoint. Throws Error: cancelled.
NormalPicture draw_normals(const ViewFrame& frame, const Positions& positions, const Triangles& F,
                           const PictureGrid& grid, Context& context);

}  // namespace formwright
