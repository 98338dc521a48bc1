// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The flat ribbon as a cloth to be zipped: triangles in the plane, which places of its edge meet, and where the design
// says that they end up.
#include <vector>

#include "base/context.h"
#include "geometry/mesh/triangle_mesh.h"
#include "zippable/flat_design.h"

namespace formwright {

/// Two places of the ribbon's edge that the slider brings together.
struct SeamPair {
  int left = 0, right = 0;  // vertices
  double along_mm = 0;      // of the zipper that the slider has passed when it comes here
  double length_mm = 0;     // of the zipper that this pair stands for
};

/// Two places of openings that are drawn together by hand once the slider has passed everything.
struct ClosurePair {
  int left = 0, right = 0;  // vertices on the cut's left and right side
  int closure = 0;
  double along_mm = 0;   // of the cut
  double length_mm = 0;  // of the cut that this pair stands for
};

struct RibbonPattern {
  TriangleMesh flat;                         // z = 0; oriented like the surface: its outside is up
  Positions predicted_mm;                    // per vertex, as designed; no triangle is stretched by it
  std::vector<SeamPair> seams;               // in the order of the slider
  std::vector<ClosurePair> closures;         // cut by cut, along each
  std::vector<double> closed_at_mm;          // per triangle: where the slider is when it has passed all around it
  std::vector<int> triangle_of_design;       // per triangle: the one of the design that it is a part of
  std::vector<double> turn_of_triangle_rad;  // per triangle: from `flat` to the sheet that it is cut from
  /// Per triangle, in the plane of `flat`: from there to the cloth that lies free. Empty where all is as designed.
  std::vector<Eigen::Matrix2d> cloth_change;
  double zipper_mm = 0;  // length of one side
  double width_mm = 0;   // mean width: area over length
  double size_mm = 0;    // largest dimension of the predicted shape
};

/// A place of the ribbon's edge before pairs are formed.
struct RibbonEdgePlace {
  Vec2 flat_mm = Vec2::Zero();
  Vec3 predicted_mm = Vec3::Zero();
  int sample = -1;  // of the zipper, counted along it; -1 on an opening
  int piece = -1;   // stretch of the zipper from opening to opening
  bool left = true;
};

/// Edges longer than `edge_mm` are halved, the longest first, seams and closures on both sides alike; 0: triangles as
/// they are. Where one side of a closure has a vertex that the other lacks, the other's edge is divided there. Throws
/// Error{invalid_input, "design"}: a triangle that names no place or has no area, a place of the zipper with no one
/// place opposite, nothing at all. Throws cancelled.
RibbonPattern make_ribbon_pattern(const std::vector<RibbonEdgePlace>& places, const Triangles& triangles,
                                  double edge_mm, Context& context, const std::vector<HandleClosure>& closures = {});

struct RibbonDesign {
  std::vector<RibbonEdgePlace> places;
  Triangles triangles;
  std::vector<HandleClosure> closures = {};
  std::vector<double> turn_of_triangle_rad = {};  // on its sheet; empty: none is turned
};

RibbonDesign ribbon_of(const FlatDesign& design);

/// make_ribbon_pattern of a whole design, with the turns of its triangles.
RibbonPattern pattern_of(const RibbonDesign& design, double edge_mm, Context& context);

}  // namespace formwright
