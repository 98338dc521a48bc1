// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A short tour of many paths: nearest neighbour, then 2-opt and or-opt moves and a better start for every closed path.
#include <vector>

#include "base/context.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

struct RouteStop {
  enum class Kind {
    loop,           // a closed path: left where it was entered, which may be at any of its doors
    line,           // an open path: entered at either of its two doors, left at the other one
    one_direction,  // entered at the first of its two doors, left at the second one
  };
  Kind kind = Kind::loop;
  std::vector<Vec2> doors_mm;
};

struct RouteStep {
  int stop = 0, door = 0;
};

/// Every stop once, beginning at `start_mm` and open at its end. Improves until a round gains less than a thousandth,
/// or `max_rounds`; windows of neighbours in the row are searched, the whole row below 2,000 stops. Deterministic.
std::vector<RouteStep> short_route(const std::vector<RouteStop>& stops, const Vec2& start_mm, const Context& context,
                                   int max_rounds = 20);

double route_length_mm(const std::vector<RouteStop>& stops, const std::vector<RouteStep>& route, const Vec2& start_mm);

}  // namespace formwright
