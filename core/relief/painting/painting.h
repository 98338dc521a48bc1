// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a maker painted onto a model: which parts matter more, and which have limits of depth of their own.
#include <Eigen/Core>
#include <array>
#include <string_view>
#include <vector>

namespace formwright {

enum class PaintedRegion : unsigned char {
  usual,         // the limits of depth that the rest has
  free,          // no limit towards the viewer
  on_base,       // on the surface of the base
  own_thickness  // limits of its own
};
inline constexpr std::array<std::string_view, 4> painted_region_names{"usual", "free", "on_base", "own_thickness"};

inline constexpr double min_painted_weight = 0.01, max_painted_weight = 100;
inline constexpr double max_painted_depth_mm = 1000;

/// Values of the vertices of one mesh. Every vector has one entry a vertex, or is empty.
struct Painting {
  Eigen::VectorXd weight;             // factor on w_i of eq. (3.13); empty: 1
  std::vector<PaintedRegion> region;  // empty: usual
  // Where the region is own_thickness; NaN, or empty: as everywhere.
  Eigen::VectorXd thickness_mm;    // how far before the base
  Eigen::VectorXd carve_depth_mm;  // how far behind it, at least -thickness_mm; below 0 the surface keeps off the base

  bool empty() const { return weight.size() == 0 && region.empty(); }
  PaintedRegion region_of(Eigen::Index vertex) const {
    return region.empty() ? PaintedRegion::usual : region[static_cast<std::size_t>(vertex)];
  }
  /// Whether any vertex has a region that is not `usual`.
  bool bounds_depth() const;
};

/// The painting of a mesh whose vertex i stands for vertex `origin[i]` of the painted one.
Painting painting_of(const Painting& painting, const std::vector<int>& origin);

}  // namespace formwright
