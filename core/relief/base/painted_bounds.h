// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Limits of depth where they are painted: eq. (3.10) with values of each vertex.
#include "relief/base/depth_bounds.h"

namespace formwright {

/// `only_outline`, "we constrain only the visual hull vertices" (thesis, Fig. 3.10): what is not painted otherwise and
/// does not belong to the outline is free.
Painting free_within_outline(const Painting& painting, const Visibility& visibility);

/// Before the base is looked for: fills `above_of` and `below_of`, gives painted vertices the limits of a flat base,
/// and bounds those that are painted with limits, hidden ones too. A vertex painted free has the room of the rest.
void set_painted_room(const Painting& painting, const ReliefOptions& options, DepthBounds& bounds);

/// After the base is found: fills `reach`. Vertices painted free may come towards the viewer until half-way to the
/// viewpoint; straight on, until as far before their usual limit as the model is deep or wide, whichever is more.
void open_free_regions(const ViewFrame& frame, const Painting& painting, DepthBounds& bounds);

}  // namespace formwright
