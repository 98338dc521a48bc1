// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Zipped objects with a known truth, measured with a tape and scanned: smaller triangles, another cloth and noise,
// which a diagnosis does not know of.
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "evidence/models/zippable/measured_zippable.h"

namespace formwright::virtual_lab {

struct HiddenMaking {
  ZippingOptions options;  // cloth, errors of making, stuffing, weight
  double marks_scale = 0, tape_scale = 0;
  std::optional<double> tucked_limb = {};  // 0 to 1, of the limbs in the order in which the zipper comes to them
};

struct ZippableObservation {
  int zipped_lengths = 40, flat_lengths = 12;
  double tape_sigma_mm = 0.5;
  int scan_points = 0;
  double scan_sigma_mm = 0.2;
  bool hangs = false;
};

/// What every virtual object is set up as: cotton.
ZippingOptions usual_cloth();

/// All causes that these objects can show.
std::vector<std::string> zippable_cause_names();

/// `level`: 1 strong. Signs are drawn. `size_mm`, `width_mm`: of the design and its ribbon.
void hide_cause(const std::string& cause, double level, double size_mm, double width_mm, std::mt19937& random,
                HiddenMaking& making);

/// The number of the limb that `making` turns inside out, counted from 1 along the zipper; 0: none, or there is no
/// limb.
int hidden_limb(const FlatDesign& design, const HiddenMaking& making);

/// The usual cloth with a stiffness that nobody has measured, without any error.
HiddenMaking draw_making(std::mt19937& random);

/// Zips `design` up as `making` has it and measures it. Throws Error{could_not_solve}.
MeasuredZippable make_zippable(const std::string& name, const FlatDesign& design, const HiddenMaking& making,
                               const ZippableObservation& observation, std::mt19937& random);

}  // namespace formwright::virtual_lab
