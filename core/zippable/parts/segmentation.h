// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A surface cut into parts that are cylinders: thesis Sec. 5.2.1.
//
// Of a part with a neighbour, one boundary loop ("line") is the transition to its neighbours and the other an
// opening of the surface; a surface that is one part has two openings. An interface is an arc of edges that
// exactly two parts share; its ends are where three parts meet, or there are none when it is a whole loop.
#include <string>
#include <vector>

#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// A stretch of a transition line along one interface.
struct InterfaceUse {
  int interface = 0;
  bool forward = true;  // along the interface's own direction, or against it
};

/// A closed walk of vertices with the part's faces to the left; the first vertex is not repeated.
struct BoundaryLine {
  std::vector<int> vertices;
  std::vector<InterfaceUse> uses;  // in the order of the walk, which begins with the first; empty for an opening
  bool is_open() const { return uses.empty(); }
};

struct Segment {
  BoundaryLine bottom;  // the transition line; an opening when the part is alone
  BoundaryLine top;     // an opening
  int face_count = 0;
};

struct Interface {
  int left = 0, right = 0;    // parts on either side of the walk
  std::vector<int> vertices;  // from end to end; a closed one repeats its first vertex
  bool is_closed() const { return vertices.front() == vertices.back(); }
};

struct Segmentation {
  TriangleMesh mesh;
  std::vector<int> face_segment;  // per face
  std::vector<Segment> segments;
  std::vector<Interface> interfaces;
  /// Per part, why it is not a cylinder with usable lines: one sentence each; empty when it is one.
  std::vector<std::string> problems;

  bool valid() const;
  int part_count() const { return static_cast<int>(segments.size()); }
};

/// Finds the lines and interfaces of parts given per face (numbered from 0, none missing). Edges inside a part that
/// join two vertices of one line are split in the middle, so that no triangle can be crushed onto the line.
/// Needs a connected, manifold, oriented mesh. What is wrong with a part is said in `problems`.
/// Throws Error{invalid_input, "mesh"}: not manifold, not connected, or without an opening.
Segmentation make_segmentation(const TriangleMesh& mesh, const std::vector<int>& face_segment);

/// Sum of edge lengths along the walk, in mm; `closed` adds the path back to its first vertex.
double walk_length_mm(const TriangleMesh& mesh, const std::vector<int>& vertices, bool closed);

}  // namespace formwright
