// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Threads may add up what triangles do to their corners without getting into each other's way, and in the same order
// whatever their number: the triangles are cut into strips, of which every other one is worked on at a time.
#include <functional>
#include <vector>

#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

class FaceStrips {
 public:
  /// Strips begin at multiples of four faces and hold at least `min_faces`. A sheet whose faces are numbered row
  /// by row falls into many; one without such an order in one or two.
  FaceStrips(const Triangles& F, int min_faces);
  FaceStrips() = default;

  /// body(first_face, end_face) for every strip: first those of even number, then the others. No two that run at the
  /// same time share a vertex.
  void for_each(const std::function<void(int first_face, int end_face)>& body) const;

  int count() const { return static_cast<int>(first_.size()) - 1; }

 private:
  std::vector<int> first_{0};
};

}  // namespace formwright
