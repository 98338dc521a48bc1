// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Where the reliefs of one viewpoint may be: before and behind the surfaces of their pillars, and out of sight of every
// other viewpoint's picture.
#include <span>
#include <vector>

#include "relief/forest/plan/seen_walls.h"
#include "relief/forest/plan/wall_reach.h"

namespace formwright {

/// How far reliefs may stand before the pillars' surfaces and be carved into them.
struct WallSpace {
  double above_mm = 0, below_mm = 0;
};

/// The plan of all viewpoints: ranges of tangents, and what each sees in its range.
struct SeenPlan {
  std::span<const Pillar> pillars;
  std::span<const PlanView> views;
  std::span<const std::vector<WallStrip>> strips;  // of each viewpoint
};

/// Whether nothing stands between a viewpoint and a place in its range of tangents. Places beyond the range are not in
/// sight. On the surface of a pillar round-off decides.
bool is_in_sight(const SeenPlan& plan, std::size_t view, const Vec2& place);

/// The last place, as b between `near` and `far`, of a line e + b d that is in sight of a viewpoint; `near` where none
/// is. Exact up to round-off.
double last_in_sight(const SeenPlan& plan, std::size_t view, const Vec2& e, const Vec2& d, double near, double far);

/// What is given must outlive it.
class ReliefSpace {
 public:
  /// `hidden_from_others`: whether reliefs keep out of other viewpoints' pictures. Then `near` of a reach is moved back
  /// to where none of them sees it, and is at the surface where that is nowhere.
  ReliefSpace(const SeenPlan& plan, std::size_t view, const WallSpace& space, bool hidden_from_others)
      : plan_(plan), view_(view), space_(space), hidden_from_others_(hidden_from_others) {}

  const PlanView& plan_view() const { return plan_.views[view_]; }
  const Pillar& pillar(int index) const { return plan_.pillars[static_cast<std::size_t>(index)]; }
  const WallSpace& space() const { return space_; }
  /// Of the ray with tangent t, which meets that edge first.
  WallReach reach(int pillar, int edge, double t) const;

 private:
  SeenPlan plan_;
  std::size_t view_;
  WallSpace space_;
  bool hidden_from_others_;
};

}  // namespace formwright
