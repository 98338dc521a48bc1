// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A zippable design as its plans and its simulation need it: the ribbon's boundary, its zipper sides and its triangles,
// from design.json.
#include <vector>

#include "base/bytes.h"
#include "geometry/mesh/triangle_mesh.h"
#include "zippable/curve/handle_closure.h"

namespace formwright {

struct FlatVertex {
  Vec3 position_mm;
  Vec2 flat_mm;
  int sample = -1;  // of the zipper; -1 on an opening
  bool left = true;
};

struct FlatDesign {
  std::vector<FlatVertex> boundary;  // counter-clockwise in the plane, all of the ribbon's vertices
  Triangles F;                       // over the boundary, counter-clockwise in the plane
  std::vector<int> fabric_of_face;   // 0 or 1; all 0 where there is one fabric
  int fabrics = 1;
  std::vector<std::vector<int>> pieces;  // zipper samples from opening to opening, in the order of the zipper
  std::vector<HandleClosure> closures;   // what meets along the openings; none in files from before there were any
  // From here on made on reading:
  std::vector<int> left_vertex, right_vertex;  // per sample: on the boundary
  std::vector<int> piece_of;                   // per sample
  std::vector<double> arclength_mm;            // per sample: along the whole zipper, openings not counted
  double zipper_mm = 0;

  int vertex_count() const { return static_cast<int>(boundary.size()); }
  int next(int v) const { return v + 1 < vertex_count() ? v + 1 : 0; }
  /// Is the boundary's edge from v to the next vertex a side of the zipper (or along an opening)?
  bool zipper_edge(int v) const;
  /// The boundary's vertex where edge `k` of a run begins; as many as edges: where the last one ends.
  int vertex_of(const ClosureRun& run, int k) const { return (run.first_vertex + k) % vertex_count(); }
  double length_in_space_mm(int a, int b) const { return (boundary[a].position_mm - boundary[b].position_mm).norm(); }
};

/// What zippable-design has written. Throws Error{invalid_input, "design"}: not such a file, a ribbon that is no disc
/// with every vertex on its boundary, numbers that are not finite, sides that differ.
FlatDesign read_flat_design(ByteView bytes);

}  // namespace formwright
