// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What the zipper does not close: cut handles and slits, laid one edge over the other with hook-and-loop tape, and what
// is marked on the cloth for it. Thesis Sec. 5.5, Fig. 5.3.
#include <array>
#include <string>
#include <vector>

#include "base/context.h"
#include "zippable/plan/pieces/markers.h"
#include "zippable/plan/pieces/splitting.h"

namespace formwright {

/// The side that carries the tape within its edge and lies on top, and the one that carries it on an allowance below.
enum class ClosureSide { hook, loop };

struct ClosureMarkOptions {
  double tape_mm = 20;        // width of the hook-and-loop tape; 0: edges are joined without one
  double flap_mm = 20;        // depth of the allowance along the loop side; 0: none
  double flap_length_mm = 0;  // along the edge, about, of one flap; 0: as long as the edge
  double marker_spacing_mm = 30;
  double clearance_mm = 0.25;  // between cuts that are not neighbours
};

/// Edges of a side that follow each other on one piece. The ribbon lies to the left.
struct ClosureStretch {
  int cut = 0;  // from 1
  ClosureSide side = ClosureSide::hook;
  int piece = 0;
  std::vector<int> vertices;  // of the boundary
  double from_mm = 0,
         to_mm = 0;  // along the cut; from above to on the loop side; around a loop's origin where not ordered so
};

/// What is added beyond an edge: its outer corners from one end to the other.
struct EdgeFlap {
  int piece = 0;
  int from_vertex = 0, to_vertex = 0;  // of the boundary
  std::vector<Vec2> outer_mm;
  std::vector<std::array<Vec2, 3>> triangles;  // that it covers
};

/// The same place of the cut on both sides.
struct ClosureMarker {
  int cut = 0, number = 0;  // from 1; from 0, at multiples of the spacing
  double along_mm = 0;
  std::array<SideMark, 2> sides;  // hook, loop
};

/// A line of the tape's width inside a hook edge, where there is cloth.
struct TapeEdge {
  int cut = 0, piece = 0;
  std::vector<Vec2> points_mm;
};

struct ClosureMarks {
  std::vector<ClosureStretch> stretches;
  std::vector<EdgeFlap> flaps;
  std::vector<ClosureMarker> markers;
  std::vector<TapeEdge> tape_edges;
  std::vector<double> length_mm;  // per cut
  double narrow_mm = 0;           // of hook edges where the piece is narrower than the tape
  double shallow_mm = 0;          // of loop edges whose allowance is less deep: there was no room for it

  double total_mm() const;
};

/// `flat_mm`: with room for the zipper, as split. Throws Error: cancelled.
ClosureMarks mark_closures(const FlatDesign& design, const std::vector<Vec2>& flat_mm, const Splitting& splitting,
                           const ClosureMarkOptions& options, const Context& context);

/// "HOOK 1", "LOOP 1"; "JOIN 1" of paper.
std::string closure_words(int cut, ClosureSide side, bool tape);

}  // namespace formwright
