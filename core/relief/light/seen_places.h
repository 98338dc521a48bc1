// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a viewer sees in the middle of every pixel of a picture: of the solid, and of the model in its place.
#include "relief/light/lit_relief.h"

namespace formwright {

/// A picture about the middle of the plate, as a viewer before it sees it, or beside: turned about the upright
/// through the middle. x right, y up, z towards the viewer, mm.
struct PictureView {
  double distance_mm = 0;  // of the eye from the middle; 0: from very far away
  double aside_deg = 0;    // to the right of straight in front
  int columns = 0, rows = 0;
  double pixel_mm = 0;  // in the plane through the middle that faces the eye

  std::size_t pixels() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
};

/// Straight on.
PictureView picture_of_plate(PlateSize plate, double pixel_mm, double distance_mm);

/// As large as holds the solid from every side: of one size at every angle. From nearer than twice the solid's reach
/// to the side it is as from there, and what comes nearer to the eye may be cut off.
PictureView picture_around(const LitObject& solid, double pixel_mm, double distance_mm, double aside_deg);

/// Of the solid: the point of the plate below what is seen, in pixels row by row from the bottom.
struct SeenRelief {
  std::vector<char> covered;
  std::vector<Vec2> point;  // x, y, mm; 0 where nothing is seen

  /// Bilinear values of nodes, 0 where nothing is seen.
  std::vector<double> values(const LitRelief& relief, const std::vector<double>& of_nodes) const;
};
/// Throws Error: cancelled.
SeenRelief see_relief(const PictureView& view, const LitObject& solid, Context& context);

/// Of the model: a place and its normal for each pixel that it covers.
struct SeenModel {
  std::vector<int> place_of_pixel;  // in pixels row by row from the bottom; -1 where it is not seen
  SurfacePoints places;             // towards the viewer, normals interpolated from the vertices

  std::vector<double> values(const std::vector<double>& of_places) const;  // 0 where it is not seen
};
/// Places are lifted onto the smooth surface that their normals belong to, so that no triangle shades its own middle
/// (Hanika 2021). `mesh`: that of `model`, outside counter-clockwise. Throws Error: cancelled.
SeenModel see_model(const PictureView& view, const LitObject& model, const TriangleMesh& mesh, double clearance_mm,
                    Context& context);

}  // namespace formwright
