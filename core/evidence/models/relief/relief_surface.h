// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The front of a finished relief as heights over a grid, with what a machine and a light do to it.
#include <Eigen/Core>
#include <string>

#include "base/context.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// Heights over a rectangle, row by row from its lower left corner, towards the viewer. Rows: y, columns: x.
struct ReliefSurface {
  double pixel_mm = 1;
  Vec2 lower_mm = Vec2::Zero();  // of the first height
  Eigen::MatrixXd height_mm;     // where the mesh leaves holes, the lowest of its heights
  /// Of the surface that the relief was worked into; empty: not known.
  Eigen::MatrixXd base_mm;
  /// Where the relief is; empty: everywhere.
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> covered;

  /// The uppermost surface of `mesh` (mm, z towards the viewer), `pixels` along its longer side, and, where `base` is
  /// given, that of the base. Throws Error: invalid_input (`where`: no extent in x and y; the relief reaches beyond its
  /// base), cancelled.
  static ReliefSurface of(const TriangleMesh& mesh, const TriangleMesh* base, int pixels, const std::string& where,
                          Context& context);

  bool is_covered(Eigen::Index row, Eigen::Index column) const { return covered.size() == 0 || covered(row, column); }
  /// Column and row of a place, not rounded.
  Vec2 on_grid(const Vec2& place_mm) const { return (place_mm - lower_mm) / pixel_mm; }
  Vec2 size_mm() const {
    return pixel_mm * Vec2(static_cast<double>(height_mm.cols()), static_cast<double>(height_mm.rows()));
  }
  /// Whether one of the four heights around a place is the relief's.
  bool holds(const Vec2& place_mm) const;
  /// Of values on the grid, at a place, between those around it that are the relief's.
  double at(const Eigen::MatrixXd& values, const Vec2& place_mm) const;
  /// Lowest and highest height of the relief.
  Vec2 height_range_mm() const;
  /// Unit normal, from the neighbours that are the relief's.
  Vec3 normal(Eigen::Index row, Eigen::Index column) const;

  /// As a machine makes it that rounds detail by a Gaussian of `blur_mm` and loses a share of the depth: that over the
  /// base, where it is known.
  ReliefSurface made_with(double blur_mm, double depth_shrinkage) const;
};

/// Gaussian blur of heights, sigma in pixels; the edge is continued. `covered`: heights that count, or empty.
Eigen::MatrixXd blurred(const Eigen::MatrixXd& height, double sigma_pixels,
                        const Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>& covered = {});

/// 1 where the light reaches a height, 0 in the shadow of another, between at its edge; `light`: unit vector towards
/// it.
Eigen::MatrixXd lit(const ReliefSurface& surface, const Vec3& light);

}  // namespace formwright
