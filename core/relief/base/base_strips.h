// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A base of strips side by side, each turned against the one before by the same angle: a bay window or a folding
// screen. Thesis Fig. 3.15 has five planes 22.5 degrees apart.
#include <vector>

#include "relief/base/base_bands.h"
#include "relief/view/relief_options.h"
#include "relief/view/view_frame.h"

namespace formwright {

struct BaseStrips {
  BaseBands bands;
  std::vector<double> t,
      z;  // of the two ends and of the folds between, from one side to the other; the foremost z is 0
};

/// All strips have the same width. From the viewpoint their two ends are seen at the ends of the plate, which reaches
/// `half_across` from the middle in the direction `turn_deg`; all lengths normalised.
/// Throws Error{invalid_input, "base_fold_deg"}: a strip would be seen from its edge or from behind.
BaseStrips base_strips(const ReliefOptions& options, const ViewFrame& frame, double half_across, double turn_deg);

}  // namespace formwright
