// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/sheet/sheet_effects.h"

#include <Eigen/Dense>
#include <numbers>

#include "base/error.h"

namespace formwright {
namespace {

constexpr double min_factor = 0.05;  // of stiffness or thickness anywhere on the sheet

}  // namespace

void check_effects(const SheetEffects& effects) {
  const auto min_over_corners = [](double x, double y) { return 1 - std::abs(x) - std::abs(y); };
  if (!(min_over_corners(effects.heating_gradient_x, effects.heating_gradient_y) > min_factor))
    throw Error(
        ErrorCode::invalid_input, "heating_gradient_x",
        "The heating differences leave a corner of the sheet without stiffness: together they must be less than 0.95.");
  if (!(min_over_corners(effects.thickness_wedge_x, effects.thickness_wedge_y) > min_factor))
    throw Error(
        ErrorCode::invalid_input, "thickness_wedge_x",
        "The thickness differences leave a corner of the sheet without thickness: together they must be less than 0.95.");
}

Placement displaced(const Placement& nominal, const SheetEffects& effects) {
  if (effects.mould_shift_x_mm == 0 && effects.mould_shift_y_mm == 0 && effects.mould_rotation_deg == 0 &&
      effects.mould_scale == 0)
    return nominal;
  const double scale = 1 + effects.mould_scale;
  const Eigen::Matrix3d turn =
      scale * Eigen::AngleAxisd(effects.mould_rotation_deg * std::numbers::pi / 180, Vec3::UnitZ()).toRotationMatrix();
  Placement real = nominal;
  real.linear = turn * nominal.linear;
  real.translation = turn * nominal.translation + Vec3(effects.mould_shift_x_mm, effects.mould_shift_y_mm, 0);
  real.scale = scale * nominal.scale;
  return real;
}

}  // namespace formwright
