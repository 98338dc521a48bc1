// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The forming as a film that any glTF viewer plays: the sheet with one morph target a moment, coloured by thickness.
#include <vector>

#include "base/bytes.h"
#include "base/context.h"
#include "thermoform/forming.h"

namespace formwright {

/// Metres, y up, as glTF wants; the mould rises with the platform. Mesh 0 is the sheet: its base is the flat sheet in
/// the clamp; targets are differences from it in POSITION and COLOR_0, one for each frame after the first, with weights
/// 1 at the frame's time. `extras` of the sheet's mesh: frame_times_s, frame_phases, platform_z_mm, touching_share,
/// thickness_mm [least, most] of the colours. `mould` (machine coordinates) may have no faces.
Bytes write_forming_glb(const FormedResult& result, const TriangleMesh& mould, double sheet_thickness_mm,
                        Context& context);

}  // namespace formwright
