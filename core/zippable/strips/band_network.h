// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The borders between bands with fewer points, the same on both sides, and the loops of them around every band.
#include <vector>

#include "zippable/strips/distance_bands.h"

namespace formwright {

struct BandNetwork {
  std::vector<Vec3> points_mm;
  /// Per band, its loops: closed walks over points with the band to the left, the first not repeated.
  std::vector<std::vector<std::vector<int>>> loops;
};

/// Borders run from where three bands meet to the next such place; each is sampled about every `sample_mm`, with a
/// point between its ends at least, two on a closed one. Borders of parts, which follow edges, are smoothed along
/// themselves.
BandNetwork band_network(const Bands& bands, double sample_mm);

}  // namespace formwright
