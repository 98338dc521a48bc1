// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Limbs of a closed surface: what a short loop cuts off, such as a star's arm or a cat's leg; and the same surface with
// a limb turned inside out.
#include <Eigen/Core>
#include <vector>

#include "base/context.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// What lies nearer to its tip, along the surface, than its neck does. The neck is a loop of equal distance.
struct Limb {
  int tip = 0;                  // vertex
  Eigen::VectorXd distance_mm;  // per vertex, along the surface from the tip
  double length_mm = 0;         // of distance, from the tip to the neck
  double neck_mm = 0;           // length of the loop
  double area_mm2 = 0;          // beyond the neck
  Vec3 centre = Vec3::Zero();   // of the loop
  Vec3 towards = Vec3::Zero();  // normal of the loop's plane, of length 1, towards the tip
};

/// Limbs of which none holds the tip of another, the largest first, at most `max_count`. Tips are prominent maxima of
/// the mean distance (limb_tips.h). About each of them a geodesic ball grows, up to half of the whole surface. A limb
/// ends where the surface first widens: where the ball's boundary, which grows in proportion to some power of its
/// radius, suddenly grows faster. Of the loops before that the neck is the one that is shortest for what it cuts off,
/// which has the largest ratio of area to squared length (the isoperimetric ratio). Loops about the tip of a ball, a
/// cone or a tube never widen so, and neither has a limb. `mesh`: one connected, oriented surface in mm; small openings
/// do no harm. The same for a mesh that is turned, moved or scaled. Throws cancelled.
std::vector<Limb> find_limbs(const TriangleMesh& mesh, int max_count, Context& context);

/// `x` (rows as limb.distance_mm has them) with the limb mirrored in the plane of its neck, so that it lies inside of
/// the rest. Within a sixth of the limb's length the mirroring sets in, and the limb is drawn together there, so that
/// no triangle is folded flat.
Positions tucked_in(const Positions& x, const Limb& limb);

}  // namespace formwright
