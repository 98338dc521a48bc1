// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Will the formed shell come off, and will the sheet reach in? Draft, undercuts and depth to width of a placed model.
#include <string>
#include <vector>

#include "base/context.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

struct DraftMap {
  TriangleMesh mesh;           // the surface above the plate, without what stands on it; machine coordinates
  Eigen::VectorXd draft_deg;   // per vertex: angle between the surface and the pull direction (up), from its normal;
                               // 90 is a floor, 0 an upright wall, negative leans over
  std::vector<char> undercut;  // per vertex: something lies above it
  Eigen::VectorXd depth_to_width;  // per vertex that faces up by 30 degrees or more: of the narrowest cavity around
                                   // it, 0 on the open and elsewhere
  Eigen::VectorXd face_draft_deg;  // per face, of its own plane
  std::vector<char> face_undercut;

  double area_mm2 = 0, undercut_area_mm2 = 0, below_3_deg_area_mm2 = 0;
  double draft_min_deg = 90;
  double depth_to_width_max = 0;   // that 10 mm^2 seen from above exceed
  Vec3 deepest_mm = Vec3::Zero();  // where that is
  std::vector<std::string> sentences;
};

/// `solid`: a closed mesh that stands on z = 0, as ExactSolid::above makes it. A face counts as undercut if the ray
/// from its centre straight up meets the solid. Depth to width is taken along six directions, on heights that `cells`
/// vertical rays across the model's longer side find: each pair of walls facing each other counts with the lower one's
/// height over the point, divided by their distance. Gaps narrower than `sheet_thickness_mm` are closed before: no
/// sheet goes into them. Throws Error{cancelled}.
DraftMap draft_map(const TriangleMesh& solid, double sheet_thickness_mm, int cells, Context& context);

/// Heights over the base plate on a grid, by rays from above; 0 beside the model.
struct HeightGrid {
  Vec2 lower_mm = Vec2::Zero();  // node (0, 0)
  double pitch_mm = 1;
  int columns = 0, rows = 0;
  std::vector<double> height_mm;  // row by row
  double top_mm = 0;              // the greatest of them

  /// The least of the four nodes around a place; 0 outside. Beside an upright wall this is the floor, so that a line
  /// along the wall does not take it for two walls.
  double min_around(double x_mm, double y_mm) const;
};
HeightGrid height_grid(const TriangleMesh& solid, int cells, Context& context);

/// Fills whatever a square of `width_mm` does not fit into (greyscale closing).
HeightGrid closed_grid(const HeightGrid& grid, double width_mm);

/// The largest of (lower wall's height over `p`) / (distance between the walls) over six pairs of opposite directions;
/// walls closer than `min_width_mm` count as that far apart. Below 0.1 it is 0.
double depth_to_width_at(const HeightGrid& grid, const Vec3& p, double min_width_mm);

}  // namespace formwright
