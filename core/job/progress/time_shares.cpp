// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/progress/time_shares.h"

#include <algorithm>

namespace formwright {

int time_share_index(double fraction) {
  constexpr int last = static_cast<int>(std::tuple_size_v<TimeShares>) - 1;
  return std::clamp(static_cast<int>(fraction * (last + 1) + 1e-9), 0, last);
}

}  // namespace formwright
