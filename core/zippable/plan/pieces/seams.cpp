// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/plan/pieces/seams.h"

#include <algorithm>

#include "zippable/plan/pieces/plan_pieces.h"

namespace formwright {
namespace {

void add_joins(const Splitting& splitting, const std::vector<Vec2>& flat, int first_piece, std::vector<Seam>& seams) {
  std::vector<char> joined(std::size_t(splitting.piece_count), 0);
  joined[first_piece] = 1;
  for (std::size_t done = 0; done < splitting.splits.size(); ++done)
    for (std::size_t s = 0; s < splitting.splits.size(); ++s) {
      const RibbonSplit& split = splitting.splits[s];
      if (joined[split.left] == joined[split.right]) continue;
      const int old_piece = joined[split.left] ? split.left : split.right,
                new_piece = split.left + split.right - old_piece;
      Seam seam{SeamKind::join, split_letters(static_cast<int>(s)), old_piece, new_piece};
      seam.cloth_mm = (flat[split.to] - flat[split.from]).norm();
      seams.push_back(std::move(seam));
      joined[new_piece] = 1;
      break;
    }
}

/// Stretches where both sides stay on their pieces.
void add_edges(const std::vector<TapeRun>& runs, const Markers& markers, std::vector<Seam>& seams) {
  const auto middle = std::find_if(runs.begin(), runs.end(), [](const TapeRun& run) { return !run.left; });
  auto left = runs.begin(), right = middle;
  int next_marker = 0;
  while (left != middle && right != runs.end()) {
    Seam seam{SeamKind::edge, "", left->piece, right->piece};
    seam.from_mm = std::max(left->from_mm, right->from_mm);
    seam.to_mm = std::min(left->to_mm, right->to_mm);
    // Edges of paper stay where they are: as long as the zipper.
    seam.cloth_mm = seam.tape_mm();
    seam.first_marker = next_marker;
    while (next_marker < static_cast<int>(markers.markers.size()) &&
           markers.markers[next_marker].arclength_mm <= seam.to_mm)
      ++next_marker;
    seam.last_marker = next_marker - 1;
    if (seam.to_mm > seam.from_mm) seams.push_back(seam);
    const double end = seam.to_mm;
    if (left->to_mm <= end) ++left;
    if (right->to_mm <= end) ++right;
  }
}

}  // namespace

std::vector<Seam> seams_in_order(const Splitting& splitting, const std::vector<Vec2>& flat,
                                 const std::vector<TapeRun>& runs, const Markers& markers, bool tape) {
  std::vector<Seam> seams;
  add_joins(splitting, flat, runs.front().piece, seams);
  if (!tape) {
    add_edges(runs, markers, seams);
    return seams;
  }
  for (const TapeRun& run : runs)
    seams.push_back({SeamKind::tape, run.splits, run.piece, run.piece, run.left, run.from_mm, run.to_mm, run.cloth_mm,
                     run.first_marker, run.last_marker});
  return seams;
}

}  // namespace formwright
