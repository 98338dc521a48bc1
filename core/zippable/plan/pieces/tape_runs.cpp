// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/plan/pieces/tape_runs.h"

#include <algorithm>

#include "zippable/plan/pieces/plan_pieces.h"

namespace formwright {
namespace {

/// Letters of all splits that end at this vertex of the boundary.
std::string letters_at(const Splitting& splitting, int vertex) {
  std::string letters;
  for (std::size_t s = 0; s < splitting.splits.size(); ++s)
    if (splitting.splits[s].from == vertex || splitting.splits[s].to == vertex)
      letters += (letters.empty() ? "" : "-") + split_letters(static_cast<int>(s));
  return letters;
}

}  // namespace

std::vector<int> faces_of_boundary(const Triangles& F, int vertex_count) {
  std::vector<int> faces(std::size_t(vertex_count), -1);
  for (int f = 0; f < F.rows(); ++f)
    for (int k = 0; k < 3; ++k)
      if (const int v = F(f, k); v < vertex_count && F(f, (k + 1) % 3) == (v + 1) % vertex_count) faces[v] = f;
  return faces;
}

std::vector<TapeRun> tape_runs(const FlatDesign& design, const OffsetRibbon& ribbon, const Splitting& splitting,
                               const Markers& markers) {
  const std::vector<int> face = faces_of_boundary(design.F, design.vertex_count());
  std::vector<TapeRun> runs;
  for (const bool left : {true, false}) {
    const auto& vertex = left ? design.left_vertex : design.right_vertex;
    const std::size_t first = runs.size();
    for (std::size_t p = 0; p < design.pieces.size(); ++p)
      for (std::size_t k = 0; k + 1 < design.pieces[p].size(); ++k) {
        const int a = design.pieces[p][k], b = design.pieces[p][k + 1];
        const int piece =
            splitting.piece_of_face[face[vertex[left ? a : b]]];  // the boundary runs back along the right side
        const bool begins = runs.size() == first || k == 0 || runs.back().piece != piece;
        if (begins) {
          TapeRun run{left, static_cast<int>(p), piece, design.arclength_mm[a], design.arclength_mm[a]};
          if (k > 0) run.splits = letters_at(splitting, vertex[a]);
          runs.push_back(std::move(run));
        }
        runs.back().to_mm = design.arclength_mm[b];
        runs.back().cloth_mm += (ribbon.flat_mm[vertex[b]] - ribbon.flat_mm[vertex[a]]).norm();
      }
    for (std::size_t i = first; i < runs.size(); ++i) {
      const auto before = [](const Marker& marker, double arclength_mm) { return marker.arclength_mm < arclength_mm; };
      const auto& list = markers.markers;
      const auto from = std::lower_bound(list.begin(), list.end(), runs[i].from_mm, before);
      // A marker where two runs meet belongs to the first of them, as on the cloth.
      const auto to = std::upper_bound(list.begin(), list.end(), runs[i].to_mm,
                                       [](double mm, const Marker& m) { return mm < m.arclength_mm; });
      runs[i].first_marker = static_cast<int>(from - list.begin());
      runs[i].last_marker = static_cast<int>(to - list.begin()) - 1;
      if (i > first) runs[i].first_marker = std::max(runs[i].first_marker, runs[i - 1].last_marker + 1);
    }
  }
  return runs;
}

}  // namespace formwright
