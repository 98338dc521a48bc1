// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Straight lines of the parameter domain on the surface: from the lower line of a part up to its upper line, through as
// many periods as they take.
#include <vector>

#include "zippable/chart/parameterisation.h"
#include "zippable/parts/segmentation.h"

namespace formwright {

/// A polyline over a straight line of the parameter domain: exact, because the map is linear in every triangle.
struct TracedLine {
  std::vector<double> x_mm;  // ascending; x is counted through, from one period into the next
  std::vector<Vec3> position_mm;

  /// The surface point over x, which is held to the line's ends.
  Vec3 at(double x_mm) const;
};

class LineTracer {
 public:
  /// Keeps references to both.
  LineTracer(const Segmentation& segmentation, const Parameterisation& parameterisation);

  /// From (x_low, 0) to (x_high, height), x_low < x_high. Callable from several threads.
  /// Throws Error{internal} when the map is not one-to-one.
  TracedLine trace(int part, double x_low_mm, double x_high_mm) const;

  /// The surface point of a part's lower or upper line over any x.
  Vec3 on_line(int part, bool upper, double x_mm) const;

 private:
  struct LineSides {
    std::vector<double> x;  // ascending, at the start of each side; the first is the least
    std::vector<int> halfedge;
  };
  struct Side {
    int halfedge;
    double shift;  // to add to the corners' x
  };
  Side side_at(int part, bool upper, double x_mm) const;

  const Segmentation& s_;
  const Parameterisation& p_;
  Adjacency adjacency_;
  std::vector<LineSides> lower_, upper_;
};

}  // namespace formwright
