// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The surface cut along the zipper's course and made developable: a triangulated disc all of whose vertices lie on its
// boundary, thesis Sec. 5.2.4.
//
// Rulings join points of neighbouring windings over equal x, across interfaces too, where the way on is found on the
// other side; openings are joined to the winding beside them alike. Between rulings, and where parts meet and there are
// none, the triangles with the shortest sides fill in.
#include <vector>

#include "base/context.h"
#include "zippable/curve/handle_closure.h"
#include "zippable/curve/zipper_curve.h"

namespace formwright {

struct RibbonVertex {
  Vec3 position_mm;
  int sample = -1;   // of the curve; -1 on an opening
  int piece = -1;    // of the curve; -1 on an opening
  bool left = true;  // which side of the zipper, as the curve runs
};

struct Ribbon {
  std::vector<RibbonVertex> boundary;          // the whole boundary, the ribbon to its left
  Triangles F;                                 // over the boundary's vertices, oriented like the surface
  std::vector<Vec2> flat_mm;                   // unfolded, per boundary vertex
  int rulings = 0;                             // given by equal x
  int opening_arcs = 0;                        // stretches of the boundary along openings: two, and two a Fermat spiral
  std::vector<HandleClosure> closures;         // which of them meet, at cuts that the zipper does not close
  double zipper_mm = 0;                        // length of one side
  double width_min_mm = 0, width_mean_mm = 0;  // of the rulings away from openings
  double isometry_error = 0;                   // largest change of an edge's length by unfolding, relative

  TriangleMesh formed() const;  // in space
  TriangleMesh flat() const;    // z = 0
};

/// `cuts`: what is closed by other means than the zipper. Throws Error: internal (the curve's lines cross), cancelled.
Ribbon make_ribbon(const Segmentation& segmentation, const Parameterisation& parameterisation, const LineTracer& tracer,
                   const ZipperCurve& curve, const CurveOptions& options, Context& context,
                   const std::vector<TapedCut>& cuts = {});

/// Unfolds triangle by triangle into the plane; every edge keeps its length. Needs a triangulated disc without inner
/// vertices.
std::vector<Vec2> unfold(const std::vector<Vec3>& positions_mm, const Triangles& F);

}  // namespace formwright
