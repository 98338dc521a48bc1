// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The cold mould chills the sheet where it touches, and a little around: what has grown cold is stiffer and flows less.
//
// The chill c (0 hot, 1 as cold as the mould gets it) follows dc/dt = (1 - c)/tau where the sheet touches, and
// everywhere dc/dt = (L^2/tau) laplacian c over the flat sheet. What touches with every corner is stuck and does not
// care; what counts is the sheet beside it, which the mould's cold air and radiation reach before the mould does. L
// stands for all of that: the plastic itself conducts a hundred times more slowly.
#include <array>
#include <vector>

#include "thermoform/sheet/membrane.h"
#include "thermoform/sheet/sheet_mesh.h"

namespace formwright {

constexpr double chill_time_s = 0.1, chill_reach_mm = 10;
constexpr double chilled_stiffness = 5;  // gained at full chill by cooling of strength 1

class ContactChill {
 public:
  /// A triangle as cold as can be is 1 + chilled_stiffness * `strength` times as stiff as a hot one.
  ContactChill(const SheetMesh& sheet, double strength);

  /// A step of `dt_s`, at the end of which the vertices in `held` touch (those in the clamp do not count).
  void advance(double dt_s, const HeldVertices& held);

  /// One a triangle, at least 1.
  const std::vector<double>& stiffness_factors() const { return factors_; }
  const std::vector<double>& chill() const { return chill_; }  // one a vertex, 0 to 1

 private:
  struct Edge {
    std::array<int, 2> vertex;
    double weight;
  };
  SheetMesh sheet_;
  double strength_;
  std::vector<Edge> edges_;
  std::vector<double> area_mm2_, chill_, factors_;
};

}  // namespace formwright
