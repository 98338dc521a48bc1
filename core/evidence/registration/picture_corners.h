// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Corners as a person sees them, in pixels of the scan's picture, and as the registration does, in the plane of the
// flat scan.
#include <array>
#include <optional>
#include <string>

#include "evidence/registration/scan_picture.h"

namespace formwright {

/// Where four pixels lie in the plane. `text`: "x,y x,y x,y x,y" from the picture's top left; `flat_mm` per vertex of
/// the scan. Throws Error{invalid_input, "corners"}: not four pairs, no picture, a pixel that no part of the scan
/// shows.
std::array<Vec2, 4> plane_corners(const std::string& text, const Model& scan, const ScanColours& colours,
                                  const TextureCoordinates& flat_mm);

/// The pixels that show four places of the plane; none where the picture does not.
std::array<std::optional<Vec2>, 4> picture_corners(const std::array<Vec2, 4>& place_mm, const Model& scan,
                                                   const ScanColours& colours, const TextureCoordinates& flat_mm);

}  // namespace formwright
