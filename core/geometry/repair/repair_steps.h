// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The steps of repair(), in the order in which it takes them. Not for other modules.
#include <memory>
#include <vector>

#include "base/context.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright::repair_steps {

/// A mesh under repair, which knows where its pieces came from (see RepairedMesh).
struct Draft {
  TriangleMesh mesh;
  std::vector<int> vertex_of, face_of, corner_of;

  Vec3 position(int v) const { return mesh.V.row(v); }
  void keep_faces(const std::vector<char>& keep);
  void add_vertices(const std::vector<Vec3>& positions, const std::vector<int>& stand_for);
  void add_faces(const std::vector<int>& corners, const std::vector<int>& old_faces,
                 const std::vector<int>& old_corners);
  void reverse_face(int f);
  void drop_unused_vertices();
};

/// Points faces at the first of the vertices that coincide, or lie within `tolerance`. Returns how many
/// vertices lost their use by it.
int merge_vertices(Draft& draft, double tolerance);

struct DegenerateCount {
  int removed = 0;  // triangles without area that went
  int fixed = 0;    // triangles without area that gained one when an edge was turned
};
DegenerateCount fix_degenerate_faces(Draft& draft, Context& context);

struct DuplicateCount {
  int removed = 0;       // copies
  int second_sides = 0;  // mirrored copies of whole sheets, and those that bound no solid
};
DuplicateCount remove_duplicate_faces(Draft& draft);

struct GluingCount {
  int edges_cut = 0;                     // where more than two faces met
  int vertices_split = 0;                // where separate sheets touched
  int faces_turned = 0;                  // to face as their neighbours do
  int one_sided_edges = 0;               // cut because the surface had one side only
  std::unique_ptr<Adjacency> adjacency;  // of the draft as it is now; empty when it was cut or split
};
/// Afterwards the draft is manifold and faces are oriented alike.
GluingCount make_manifold(Draft& draft, Context& context);

/// Turns closed parts (numbered per face) outwards unless they are cavities; returns how many were turned.
int turn_outwards(Draft& draft, const Adjacency& adjacency, const Components& parts, Context& context);

struct DropCount {
  int parts = 0, faces = 0;
};
DropCount drop_small_parts(Draft& draft, double min_share);

struct FillCount {
  int holes = 0, faces = 0;
};
FillCount fill_holes(Draft& draft, int max_edges, Context& context);

}  // namespace formwright::repair_steps
