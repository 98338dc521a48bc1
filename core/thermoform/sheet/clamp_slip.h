// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How a sheet's rim comes in from under a loose clamp: farthest where the sheet pulls hardest.
#include <vector>

#include "thermoform/sheet/sheet_mesh.h"

namespace formwright {

/// Dry friction holds all of the rim alike and gives way where the pull is largest, until the pull is even. Here the
/// rim comes in with the square of the pull, a smooth form of that. The pull is that on each mm of the rim, averaged
/// over 15 % of the shorter side either way, so that it does not depend on the mesh.
class ClampSlip {
 public:
  ClampSlip(const SheetMesh& sheet, const Vec2& opening_mm);
  /// Takes the pulls from the forces on the sheet's vertices (n x 3, any unit). Where nothing pulls it stays even.
  void feel(const Positions& force);
  /// Where a vertex of the rim goes, for each mm that the rim comes in where the pull is largest: inwards, at the
  /// corners from both sides, and between so smoothly that no triangle at the rim is turned over. Zero within the
  /// opening.
  Vec2 movement(int vertex) const {
    return share_[static_cast<std::size_t>(vertex)] * inward_[static_cast<std::size_t>(vertex)];
  }

 private:
  struct Neighbour {
    int vertex;
    double weight;
  };
  std::vector<int> rim_;
  std::vector<double> share_;                     // n: 1 where the pull is largest
  std::vector<Vec2> inward_;                      // n
  std::vector<Vec2> normal_per_mm_;               // of rim_: inwards, divided by the length of its stretch
  std::vector<std::vector<Neighbour>> averaged_;  // of rim_: indices into rim_; the weights' sum is 1
};

}  // namespace formwright
