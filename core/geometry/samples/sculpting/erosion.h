// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A mountain carved by its own rivers: uplift against the stream power law dh/dt = U - K A^(1/2) |slope|
// (Braun and Willett 2013, implicit in time; Cordonnier et al. 2016 for its use in graphics) with creep
// of the slopes. Nodes are jittered so that valleys do not follow the grid.
#include <vector>

#include "base/context.h"
#include "geometry/samples/sculpting/point.h"

namespace formwright::samples {

class ErodedTerrain {
 public:
  /// A square of side `side_mm` about the origin whose rim stays at height 0 and whose top is at `height_mm`.
  ErodedTerrain(double side_mm, double height_mm, Context& context);

  struct Sample {
    double height;    // mm
    double drainage;  // share of the whole square that drains through here
  };
  Sample at(double x, double z) const;

 private:
  int n_ = 0;  // nodes a side
  double side_;
  std::vector<float> jitter_x_, jitter_z_;  // in cells
  std::vector<double> height_, drainage_;
  void resize(int n);
  void erode(int steps, double time_step, Context& context);
  std::size_t node(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(n_) + static_cast<std::size_t>(i);
  }
};

}  // namespace formwright::samples
