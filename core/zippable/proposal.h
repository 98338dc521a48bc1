// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A first division into cylinders to start from: limbs become parts, each with a puncture at its tip.
#include <string>
#include <vector>

#include "base/context.h"
#include "zippable/parts/drawn_parts.h"
#include "zippable/curve/handle_closure.h"
#include "zippable/parts/segmentation.h"

namespace formwright {

struct ProposalOptions {
  double puncture_radius_mm = 5;  // at most; less where a part is narrow
  int parts_max = 10;             // 1: always a single cylinder
  /// A tip counts when it stands out from the rest by this share of the largest mean distance.
  double prominence = 0.08;
  std::vector<Vec3> tips_mm;  // where parts are to be punctured; empty: at the tips of limbs
  std::vector<std::vector<Vec3>>
      cuts_mm;  // punctures that are cuts along paths; they and `tips_mm` are all there are, if any is given
  std::vector<DrawnCurve> curves;  // borders of the parts, in mm; empty: around the punctures or limbs
  bool accept_all_parts = false;   // drawn parts that are no cylinders are not refused
  bool follow_creases = false;     // curves snap to features unless they say otherwise; found borders run in valleys
  FeatureOptions features = {};
  double snap_reach_mm = 5;  // how far a drawn point may be moved onto a feature line
};

struct Proposal {
  Segmentation segmentation;
  int handles_cut = 0;                        // loops opened, which need another closure than the zipper
  std::vector<std::vector<int>> handle_cuts;  // per cut handle, the vertices of the given mesh along the loop, closed
  std::vector<TapedCut> taped_cuts;           // what needs that closure: these loops, then slits between openings
  std::vector<std::vector<Vec3>> slits;       // as cut along the given paths
  std::vector<Vec3> punctures;                // centres
  std::vector<double> puncture_radius_mm;
  std::vector<std::string> notes;  // what was decided, in words
};

/// Tips are maxima of the mean distance to everywhere else (Hilaga et al. 2001) that stand out enough (by persistence);
/// with the openings that there are already they are the seeds. Every vertex goes to the seed that is nearest along the
/// surface, counted from where its limb ends. Seeds whose parts are not cylinders are given up, the least prominent
/// first; with two seeds left, the whole surface is one cylinder. Where `follow_creases` is set the way across a valley
/// counts as longer than it is, so that fronts meet there (the minima rule: Hoffman & Richards 1984), which moves
/// borders between neighbours into valleys that are near, and makes no other parts. With curves, the parts are what
/// they bound; those without an opening are punctured at the tip given in them, or farthest from their border. Needs
/// one connected, manifold, oriented mesh. Throws Error{invalid_input, "mesh"}: not that, or more openings than can be
/// brought onto one ribbon. Throws Error{invalid_input, "segments"} when given tips do not make cylinders; cancelled.
Proposal propose_segmentation(const TriangleMesh& mesh, const ProposalOptions& options, Context& context);

}  // namespace formwright
