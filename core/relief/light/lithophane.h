// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A plate that shows a picture when light comes through it.
namespace formwright {

/// Light is weakened exponentially on its way through a material (Bouguer, Lambert): I = exp(-mu t).
struct Lithophane {
  double min_mm, max_mm;     // thickness, min_mm < max_mm
  double absorption_per_mm;  // mu > 0
};

/// mu of a material of which a plate of 1 mm lets `share` of the light through; 0 < share < 1.
double absorption_per_mm(double share);

/// Thickness at which the light that comes through goes evenly with `brightness` (0 to 1, clamped) from what the
/// thickest to what the thinnest place lets through. Within [min_mm, max_mm].
double lithophane_thickness_mm(const Lithophane& plate, double brightness);

/// The inverse.
double lithophane_brightness(const Lithophane& plate, double thickness_mm);

}  // namespace formwright
