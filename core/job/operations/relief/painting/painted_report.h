// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a report says of a painting.
#include <algorithm>
#include <string>

#include "base/data/json.h"
#include "relief/painting/painting.h"

namespace formwright {

/// Number of vertices of each kind.
inline Json painted_vertices(const Painting& painting) {
  Json counts = {{"matters_more", (painting.weight.array() > 1).count()},
                 {"matters_less", (painting.weight.array() < 1).count()}};
  for (std::size_t k = 1; k < painted_region_names.size(); ++k)
    counts[std::string(painted_region_names[k])] = std::ranges::count(painting.region, static_cast<PaintedRegion>(k));
  return counts;
}

}  // namespace formwright
