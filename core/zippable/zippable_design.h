// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// From a model to the one ribbon that zips up into it: parts, parameterisation, curve, ribbon. Thesis Sec. 5.2.
#include <string>
#include <vector>

#include "base/context.h"
#include "geometry/point_distance.h"
#include "zippable/proposal.h"
#include "zippable/ribbon.h"
#include "zippable/zippable_options.h"

namespace formwright {

struct ZippableDesign {
  double scale = 1;              // from the given mesh to mm
  Proposal proposal;             // parts, in mm
  Parameterisation parameterisation;
  int traversal_count = 0;       // orders to choose from
  RankedTraversal traversal;     // the chosen one
  ZipperCurve curve;
  Ribbon ribbon;
  SurfaceDistance ribbon_to_model, model_to_ribbon;  // mm
  std::vector<std::string> notes;
  double seconds_parts = 0, seconds_parameterisation = 0, seconds_curve = 0, seconds_ribbon = 0, seconds_distance = 0;
};

/// `mesh`: connected, manifold, oriented. `tips`, in the mesh's coordinates: where parts are punctured, instead of where limbs end; empty for the
/// automatic proposal.
/// Throws Error: invalid_input ("mesh", "segments" for tips, or a parameter), could_not_solve, cancelled.
ZippableDesign design_zippable(const TriangleMesh& mesh, const std::vector<Vec3>& tips, const ZippableOptions& options, Context& context);

}  // namespace formwright
