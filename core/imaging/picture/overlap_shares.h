// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What of each row (or column) of a picture goes into a coarser one, by the overlap of pixels as areas.
#include <algorithm>
#include <array>
#include <vector>

namespace formwright {

template <int Most>
struct OverlapShare {
  int first = 0, count = 0;
  std::array<float, Most> weight{};  // of fine pixels first, first + 1, ...; they sum to 1
};

/// One share for each of `coarse` pixels. Precondition: 0 < coarse <= fine, and no coarse pixel overlaps more than
/// `Most` fine ones.
template <int Most>
std::vector<OverlapShare<Most>> overlap_shares(int fine, int coarse) {
  std::vector<OverlapShare<Most>> all(static_cast<std::size_t>(coarse));
  const double ratio = static_cast<double>(fine) / coarse;
  for (int i = 0; i < coarse; ++i) {
    OverlapShare<Most>& share = all[static_cast<std::size_t>(i)];
    const double from = i * ratio, to = std::min<double>(fine, (i + 1) * ratio);
    share.first = static_cast<int>(from);
    for (int k = 0; k < Most && share.first + k < fine && share.first + k < to - 1e-9; ++k, ++share.count)
      share.weight[static_cast<std::size_t>(k)] = static_cast<float>(
          (std::min<double>(to, share.first + k + 1) - std::max<double>(from, share.first + k)) / ratio);
  }
  return all;
}

}  // namespace formwright
