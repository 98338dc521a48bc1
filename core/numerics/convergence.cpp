// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/convergence.h"

#include <algorithm>
#include <cmath>

namespace formwright {

Convergence::Convergence(double tolerance) : tolerance_(tolerance) {}

double Convergence::passed(double error) {
  if (!(error >= 0) || !std::isfinite(error)) return passed_;
  const double decades = error > tolerance_ ? std::log10(error / tolerance_) : 0;
  if (decades > first_decades_ && passed_ == 0) first_decades_ = decades;
  if (first_decades_ > 0) passed_ = std::clamp(1 - decades / first_decades_, passed_, 1.0);
  else passed_ = 1;
  return passed_;
}

}  // namespace formwright
