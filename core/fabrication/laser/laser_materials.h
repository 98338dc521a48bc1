// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Materials with values to begin with: said here once, and handed on in the catalog for the page's machine profiles.
#include <string>
#include <vector>

#include "base/data/json.h"

namespace formwright {

struct LaserMaterial {
  std::string name, title;
  std::string laser;        // "co2_40w", "diode_10w"
  double thickness_mm = 0;  // 0: whatever is engraved
  Json parameters;          // values of laser-job's parameters
  std::string hint;         // what to mind with this material; may be empty
};

/// Values to begin a test with, never to cut with unseen: tubes, diodes, lenses and materials differ by a factor of
/// two. CO2 after published tables (docs/fabrication.md names them), diodes by the ratio of powers and what is passed
/// on among makers.
const std::vector<LaserMaterial>& laser_materials();

/// {"note", "materials": [{"name", "title", "laser", "thickness_mm", "parameters", "hint"}]}
Json laser_materials_json();

}  // namespace formwright
