// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Locks of hair, feathers, folds: strips that lie on a skin and thicken it. They displace the skin along its
// normal and never leave it, so that a thousand of them make no hole, no bridge and no undercut.
#include <vector>

#include "geometry/samples/sculpting/sculpture.h"

namespace formwright::samples {

struct LockStyle {
  double length = 4, width = 0.7, height = 0.5;  // width: half of it, at the widest place
  double turn = 0, curl = 0;   // turning rate in radians per unit length: at the root, and gained to the tip
  double wave = 0, waves = 0;  // a further turning rate that swings `waves` times along the lock
  double strands = 4;          // grooves across
  double groove = 0.25;        // their depth as a fraction of the height
  double root = 0.45;          // height at the root over `height`
  double tip_width = 0.2, tip_height = 0.6;  // at the tip, over the largest
};

class LockLayer {
 public:
  LockLayer(const Box& bounds, double cell) : bounds_(bounds), cell_(cell) {}

  /// Traces a lock over the skin from p, starting in `direction`.
  void lay(const Sculpture& skin, Point p, Point direction, const LockStyle& style, double phase);
  /// A lock along given points, dropped onto the skin.
  void lay(const Sculpture& skin, const std::vector<Point>& path, const LockStyle& style, double phase);
  /// Builds the grid. `softness` rounds the valleys between locks; grooves are deepened by `groove_scale`.
  void finish(double softness, double groove_scale);

  /// Thickness over the skin at p, 0 where there is no lock.
  double operator()(const Point& p) const;
  double greatest_height() const { return greatest_; }

 private:
  struct Joint {  // a point of a lock
    Point p, up;
    double width, height;
  };
  struct Segment {  // from joint to joint + 1, made ready for operator()
    Point middle;
    double ball2;  // squared radius beyond which the segment has no effect
    int lock, joint;
    Point a, ab, up, up_change;
    double inverse, width, width_change, height, height_change;
  };
  struct Lock {
    double strands, groove, phase;
    int first;
  };
  void add(std::vector<Joint> joints, const LockStyle& style, double phase);
  Box bounds_;
  double cell_, softness_ = 0.1, groove_scale_ = 1, greatest_ = 0;
  std::vector<Joint> joints_;
  std::vector<Lock> locks_;
  std::vector<Segment> segments_;
  int cells_[3] = {0, 0, 0};
  std::vector<int> first_, entries_;
};

}  // namespace formwright::samples
