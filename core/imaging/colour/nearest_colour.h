// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Colour carried beyond the edge of what is painted, so that a print that lands a little off shows no white rim.
#include "imaging/picture/image.h"

namespace formwright {

/// Every empty pixel (alpha 0) whose nearest painted one (alpha not 0), centre to centre, is at most `radius_px` away
/// takes that one's colour; of equally near ones, the same one at any number of threads. Exact distances in time that
/// does not depend on the radius: Meijster, Roerdink, Hesselink 2000. The radius counts up to 30,000.
void spread_colours(Image& image, double radius_px, const Context& context);

}  // namespace formwright
