// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a real machine does beside the model of thesis 4.2.2: uneven heat, sliding, chilling, a mould that stands a
// little off. Every effect is 0 where it is absent, and a simulation whose effects are all 0 is that of the thesis to
// the last bit.
//
// Places on the sheet are xi = 2 x / opening_x and eta = 2 y / opening_y, from -1 to 1 over the clamp's opening.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/parameters.h"
#include "thermoform/placement.h"

namespace formwright {

/// Derived from PlacementOptions only because options that are inherited must form one chain (base/parameters.h);
/// `parameters` are the effects alone.
struct SheetEffects : PlacementOptions {
  static constexpr std::string_view group_title = "Machine's own ways";

  double heating_gradient_x = 0;
  double heating_gradient_y = 0;
  double heating_centre = 0;
  double thickness_wedge_x = 0;
  double thickness_wedge_y = 0;
  double anisotropy = 0;
  double slip = 0;
  double cooling = 0;
  double weak_vacuum = 0;
  double clamp_slip_mm = 0;
  double mould_shift_x_mm = 0;
  double mould_shift_y_mm = 0;
  double mould_rotation_deg = 0;
  double mould_scale = 0;

  static constexpr auto parameters = std::tuple{
      parameter(
          "heating_gradient_x", &SheetEffects::heating_gradient_x, "Heat falls off in x", unit::none, -0.9, 0.9,
          "Share by which the sheet is stiffer (colder) at the opening's right side than in its middle, and softer at the left.")
          .group(group_title)
          .advanced(),
      parameter(
          "heating_gradient_y", &SheetEffects::heating_gradient_y, "Heat falls off in y", unit::none, -0.9, 0.9,
          "Share by which the sheet is stiffer (colder) at the opening's back than in its middle, and softer at the front.")
          .group(group_title)
          .advanced(),
      parameter(
          "heating_centre", &SheetEffects::heating_centre, "Heat falls off outwards", unit::none, -0.9, 0.9,
          "Share by which the sheet is stiffer in the opening's corners, and softer in its middle, than on average.")
          .group(group_title)
          .advanced(),
      parameter("thickness_wedge_x", &SheetEffects::thickness_wedge_x, "Thickness grows in x", unit::none, -0.9, 0.9,
                "Share by which the flat sheet is thicker at the opening's right side than in its middle.")
          .group(group_title)
          .advanced(),
      parameter("thickness_wedge_y", &SheetEffects::thickness_wedge_y, "Thickness grows in y", unit::none, -0.9, 0.9,
                "Share by which the flat sheet is thicker at the opening's back than in its middle.")
          .group(group_title)
          .advanced(),
      parameter("anisotropy", &SheetEffects::anisotropy, "Stiffer along x", unit::none, -0.9, 0.9,
                "Share by which the sheet is stiffer along x, and softer along y: extruded sheet knows its direction.")
          .group(group_title)
          .advanced(),
      parameter(
          "slip", &SheetEffects::slip, "Slip", unit::none, 0, 20,
          "One over the coefficient of friction between sheet and mould. 0: what touches sticks for ever, as in the thesis.")
          .group(group_title)
          .slider(0, 5)
          .advanced(),
      parameter(
          "cooling", &SheetEffects::cooling, "Chill on contact", unit::none, 0, 10,
          "How much the cold mould stiffens what it touches, and what is close by. 1: six times, within a tenth of a second.")
          .group(group_title)
          .slider(0, 3)
          .advanced(),
      parameter("weak_vacuum", &SheetEffects::weak_vacuum, "Vacuum missing", unit::none, 0, 0.95,
                "Share of the vacuum that leaks away.")
          .group(group_title)
          .advanced(),
      parameter("clamp_slip_mm", &SheetEffects::clamp_slip_mm, "Clamp gives way by", unit::mm, 0, 20,
                "How far the sheet's rim is drawn in from the clamp while the model comes up.")
          .group(group_title)
          .slider(0, 5)
          .advanced(),
      parameter("mould_shift_x_mm", &SheetEffects::mould_shift_x_mm, "Mould off in x", unit::mm, -50, 50,
                "How far the mould stands to the right of where it should.")
          .group(group_title)
          .slider(-5, 5)
          .advanced(),
      parameter("mould_shift_y_mm", &SheetEffects::mould_shift_y_mm, "Mould off in y", unit::mm, -50, 50,
                "How far the mould stands behind where it should.")
          .group(group_title)
          .slider(-5, 5)
          .advanced(),
      parameter(
          "mould_rotation_deg", &SheetEffects::mould_rotation_deg, "Mould turned by", unit::degrees, -180, 180,
          "How far the mould is turned about the vertical through the opening's centre, counter-clockwise seen from above.")
          .group(group_title)
          .slider(-10, 10)
          .advanced(),
      parameter("mould_scale", &SheetEffects::mould_scale, "Mould too large by", unit::none, -0.5, 0.5,
                "Share by which the mould is larger than it should be, about the centre of the opening on the plate.")
          .group(group_title)
          .slider(-0.1, 0.1)
          .advanced()};
};

/// How much stiffer than the material's modulus the sheet is at (xi, eta); 1 without effects.
inline double stiffness_factor(const SheetEffects& e, double xi, double eta) {
  const double squared_radius = std::min(1.0, 0.5 * (xi * xi + eta * eta));
  return (1 + e.heating_gradient_x * xi + e.heating_gradient_y * eta) *
         (1 + e.heating_centre * (2 * squared_radius - 1));
}

/// How much thicker than the sheet's thickness it is at (xi, eta); 1 without effects.
inline double thickness_factor(const SheetEffects& e, double xi, double eta) {
  return 1 + e.thickness_wedge_x * xi + e.thickness_wedge_y * eta;
}

/// Throws Error{invalid_input} where effects together leave the sheet no stiffness or thickness.
void check_effects(const SheetEffects& effects);

/// Where the mould really stands that should stand at `nominal`.
Placement displaced(const Placement& nominal, const SheetEffects& effects);

}  // namespace formwright
