// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Sheets and materials that the tests of this folder share.
#include <random>
#include <vector>

#include "foreign_laboratory/faults.h"
#include "foreign_laboratory/sheet/membrane.h"

namespace formwright::foreign_laboratory::test {

inline Points flat(const Grid& grid, double stretch_x = 1, double stretch_y = 1) {
  Points x(3, grid.node_count());
  for (int node = 0; node < grid.node_count(); ++node)
    x.col(node) << stretch_x * grid.flat_mm(node).x(), stretch_y * grid.flat_mm(node).y(), 0;
  return x;
}

inline Points shaken(Points x, double by, unsigned seed) {
  std::mt19937_64 random(seed);
  for (Eigen::Index k = 0; k < x.size(); ++k) x.data()[k] += uniform(random, -by, by);
  return x;
}

inline Polymer elastic(double modulus_mpa = 0.5) {
  Polymer polymer;
  polymer.lasting_modulus_mpa = modulus_mpa;
  polymer.relaxing_modulus_mpa = {0, 0};
  return polymer;
}

inline std::vector<char> rim_held(const Grid& grid) {
  std::vector<char> held;
  for (int node = 0; node < grid.node_count(); ++node) held.push_back(grid.on_rim(node));
  return held;
}

}  // namespace formwright::foreign_laboratory::test
