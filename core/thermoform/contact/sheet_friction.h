// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Finite friction between sheet and mould. A vertex that touches sticks while what the sheet pulls along the surface is
// at most mu times what presses across it; beyond, it slides: it moves along the surface only, against a drag of mu
// times that force. Which vertices slide, and their drags, are decided at the end of every step, for the next one. What
// slid forward in a step goes on sliding: one that stops as soon as its pull equals its drag would take turns with its
// neighbours, and all would be dragged too much.
//
// A vertex that the sheet pulls off the surface still adheres, and is dragged as if pressed with the same force, so
// that mu -> infinity is the infinite adhesion of thesis 4.2.2. For the same reason sharp points of the mould must not
// push out the middle of a triangle that its corners carry: the two would hold each other, and both drag. Where the
// sheet slides, points therefore count only where the mould is sharp at the scale of an edge, and may reach a little
// into a triangle.
#include <memory>
#include <vector>

#include "thermoform/solver/block_matrix.h"
#include "thermoform/sheet/membrane.h"
#include "thermoform/sheet/sheet_mesh.h"

namespace formwright {

/// What a vertex is doing: the values of HeldVertices.
enum HeldState : char { moves_freely = 0, stuck = 1, stuck_in_this_step = 2, sliding = 3 };

/// The drag on a vertex (N), and its derivative (N/mm).
struct Drag {
  double force, stiffness;
};
/// Against the direction in which the vertex was pulled at the beginning of the step; `slip_mm`: how far it has gone
/// that way. What goes back is not driven by its drag: over the first fiftieth of a millimetre that turns round.
Drag drag_of(double maximum, double slip_mm);

/// How far the mould may reach into a triangle, in edges of the sheet, before its points count as sharp
/// (MouldContact::sharp_points) and before such a point touches. 0 where nothing slides, and full from mu = 4 down, so
/// that slip -> 0 is the sheet that sticks.
struct PointReach {
  double rounded_edges = 0, sharp_edges = 0;
};
PointReach point_reach(double slip);

class SheetFriction {
 public:
  /// `coefficient`: mu, above 0.
  /// `stiffness`: of the sheet (N/mm), for the lag: what slides is also held back in proportion to its speed, stiffness
  /// and area, so that short steps slide little and always end.
  SheetFriction(const SheetMesh& sheet, double coefficient, double stiffness);

  /// The surface's normal where a vertex touches; to be kept up to date.
  Vec3& normal(int vertex) { return normal_[static_cast<std::size_t>(vertex)]; }

  /// Makes Newton's equation of a sliding vertex, which went `slip_mm` in this step of `dt_s` so far, one along the
  /// surface: drag and lag into the force, nothing across, and a stiffness across that lets it go nowhere.
  void constrain(int vertex, const Vec3& slip_mm, double dt_s, Vec3& force, std::array<Float4, 3>& diagonal) const;

  /// Whether the corners of a triangle all touch, and none of them a part of the mould that leans away from the
  /// others': what reaches into such a triangle is rounded as its corners are, no tip.
  bool carried_by_corners(const Triangles& F, int face, const HeldVertices& held) const;

  /// Who slides from now on, by the forces (n x 3, N) that act on the vertices besides those of the mould, and by how
  /// far they slid (n x 3, mm) in the step that ended. While all is `settling`, every time that a vertex starts to
  /// slide takes a larger force than the time before, as contacts that rest grow firmer; without that a few in corners
  /// and webs would hop for ever.
  void decide(const Positions& force, const Positions& slip_mm, bool settling, HeldVertices& held);

  double coefficient() const { return coefficient_; }
  /// The triangles around each vertex.
  const std::vector<std::vector<int>>& faces_of() const { return *faces_of_; }

 private:
  double coefficient_, stiffness_;
  std::vector<char> clamped_;
  std::vector<int> starts_;               // per vertex: how often it began to slide while all was settling
  std::vector<double> area_mm2_, drag_;   // of the flat sheet; N
  std::vector<Vec3> normal_, direction_;  // unit; the second of the pull along the surface
  std::shared_ptr<const std::vector<std::vector<int>>> faces_of_;  // shared: a step copies this object, to go back to
};

}  // namespace formwright
