// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// From a point of the flat sheet to where it went.
#include <optional>
#include <vector>

#include "thermoform/sheet/formed_sheet.h"

namespace formwright {

struct SheetPoint {
  int face = -1;
  Vec3 barycentric;
};

class SheetLookup {
 public:
  /// Keeps a reference to `sheet`.
  explicit SheetLookup(const FormedSheet& sheet);

  /// The face over `sheet_mm` (centred on the sheet); nothing outside of the clamp opening.
  std::optional<SheetPoint> find(const Vec2& sheet_mm) const;

  /// Where a point went: on the middle surface, or half a thickness outwards along the smooth normal.
  Vec3 middle(const SheetPoint& point) const;
  Vec3 outer(const SheetPoint& point) const;
  double thickness_mm(const SheetPoint& point) const;

 private:
  const FormedSheet& sheet_;
  Positions normals_;
  Vec2 lower_, cell_;
  int columns_ = 1, rows_ = 1;
  std::vector<std::vector<int>> faces_;  // per cell
};

}  // namespace formwright
