// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Points at exactly the same place become one vertex: how a triangle soup (STL) regains its connectivity.
#include <cstdint>
#include <vector>

#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// Numbers points in the order in which they first come; -0 and 0 are one place. Coordinates must be finite.
class VertexMerger {
 public:
  explicit VertexMerger(std::size_t expected_vertices = 0);

  /// Index of the vertex at this place, a new one if there was none.
  int add(double x, double y, double z);
  int add(const Vec3& p) { return add(p.x(), p.y(), p.z()); }

  int vertex_count() const { return static_cast<int>(points_.size() / 3); }
  Positions positions() const;

 private:
  void grow();
  std::size_t slot_of(double x, double y, double z) const;

  std::vector<double> points_;
  std::vector<int> slots_;  // open addressing, -1 where free; the size is a power of two
};

}  // namespace formwright
