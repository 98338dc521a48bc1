// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A simulated zipping as files, and as words.
#include <string>
#include <vector>

#include "base/bytes.h"
#include "zippable/zipping/zipping.h"

namespace formwright {

/// The shape, turned onto the prediction, with distance_mm and strain of every vertex (the largest of its triangles).
Bytes write_zipped_ply(const ZippingResult& result, Context& context);

/// The course from flat to zipped as a film: mesh 0 is the cloth, its base is flat, with a morph target for each frame
/// after the first, which is at rest in the last one. Metres, y up. `extras` of the mesh: zipped_share and
/// frame_times_s of each frame and distance_mm of the colours, [0, most].
Bytes write_zipping_glb(const ZippingResult& result, Context& context);

/// One sentence for a person, with the figures that decide.
std::string zipping_verdict(const ZippingResult& result, double tolerance_percent);

}  // namespace formwright
