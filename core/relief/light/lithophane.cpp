// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/light/lithophane.h"

#include <algorithm>
#include <cmath>

namespace formwright {
namespace {

double span_of(const Lithophane& plate) {
  return -std::expm1(-plate.absorption_per_mm * (plate.max_mm - plate.min_mm));
}

}  // namespace

double absorption_per_mm(double share) { return -std::log(share); }

double lithophane_thickness_mm(const Lithophane& plate, double brightness) {
  // Relative to the thinnest place, so that nothing underflows however dark the thickest is.
  const double dark = 1 - std::clamp(brightness, 0.0, 1.0);
  const double thickness = plate.min_mm - std::log1p(-dark * span_of(plate)) / plate.absorption_per_mm;
  return std::clamp(thickness, plate.min_mm, plate.max_mm);
}

double lithophane_brightness(const Lithophane& plate, double thickness_mm) {
  return 1 + std::expm1(-plate.absorption_per_mm * (thickness_mm - plate.min_mm)) / span_of(plate);
}

}  // namespace formwright
