// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Makes any heap of triangles a manifold that solvers can trust, and says in plain words what it did.
// Cutting and stitching in the manner of Gueziec, Taubin, Lazarus, Horn 2001.
#include <string>
#include <tuple>
#include <vector>

#include "base/context.h"
#include "base/data/parameters.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

struct RepairOptions {
  bool merge_duplicates = true;
  double merge_tolerance_mm = 0;
  int fill_holes_up_to_edges = 0;
  double drop_parts_below_percent = 0;

  static constexpr auto parameters = std::tuple{
      parameter("merge_duplicates", &RepairOptions::merge_duplicates, "Merge vertices",
                "Join vertices that lie at the same place."),
      parameter("merge_tolerance_mm", &RepairOptions::merge_tolerance_mm, "Merge distance", unit::mm, 0, 1000,
                "Vertices that lie at most this far apart are joined; 0 joins only those at exactly the same place.")
          .slider(0, 1)
          .advanced(),
      parameter("fill_holes_up_to_edges", &RepairOptions::fill_holes_up_to_edges, "Fill holes", unit::none, 0, 500,
                "Holes with at most this many edges are filled; 0 fills none.")
          .slider(0, 100),
      parameter("drop_parts_below_percent", &RepairOptions::drop_parts_below_percent, "Drop small parts", unit::percent,
                0, 50, "Separate parts with less than this share of the surface are dropped.")
          .slider(0, 5)};
};

struct RepairedMesh {
  TriangleMesh mesh;           // manifold, with boundary; oriented alike within each part
  std::vector<int> vertex_of;  // per vertex: the old one it stands for (the nearest one for a new vertex on an edge)
  std::vector<int> face_of;    // per face: the old one it is, or is a part of; -1 where it fills a hole
  std::vector<int> corner_of;  // per corner 3 f + k: the old corner 3 f' + k' whose attributes it takes
  int part_count = 0;          // connected parts
  int hole_count = 0;          // boundary loops
  int genus = 0;               // handles, all parts together
  std::vector<std::string> sentences;  // what was found and done; empty when there was nothing to say

  bool closed() const { return hole_count == 0; }
};

/// Merges vertices, removes triangles without area and duplicate ones, cuts apart where more than two
/// triangles share an edge or sheets touch at a vertex (keeping together what bounds one solid), orients
/// every part (outwards where closed, except cavities; by majority where open), removes unused
/// vertices. Surviving vertices and faces keep their order; new ones follow. A sound mesh comes back as
/// it was. Self-intersections are not looked for.
/// Throws Error: invalid_input with `where` = "mesh" (indices out of range, no triangle with area left,
/// coordinates beyond 1e100), cancelled.
RepairedMesh repair(const TriangleMesh& mesh, const RepairOptions& options, Context& context);

/// The model with its mesh repaired; texture coordinates, groups, materials and colours follow.
Model repaired_model(const Model& model, const RepairedMesh& repaired);

}  // namespace formwright
