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

#include "base/data/parameters.h"
#include "thermoform/sheet/placement.h"

namespace formwright {

/// Derived from PlacementOptions only because options that are inherited must form one chain (base/parameters.h);
/// `parameters` are the effects alone.
struct SheetEffects : PlacementOptions {
  static constexpr std::string_view group_title = "Machine faults";

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
          "heating_gradient_x", &SheetEffects::heating_gradient_x, "Colder towards the right", unit::none, -0.9, 0.9,
          "How much stiffer (colder) the sheet is at the right side of the opening than in its middle, as a fraction; it is as much softer at the left. 0.2 means 20 %; 0 is even heating.")
          .group(group_title)
          .advanced(),
      parameter(
          "heating_gradient_y", &SheetEffects::heating_gradient_y, "Colder towards the back", unit::none, -0.9, 0.9,
          "How much stiffer (colder) the sheet is at the back of the opening than in its middle, as a fraction; it is as much softer at the front. 0.2 means 20 %; 0 is even heating.")
          .group(group_title)
          .advanced(),
      parameter(
          "heating_centre", &SheetEffects::heating_centre, "Colder towards the corners", unit::none, -0.9, 0.9,
          "How much stiffer (colder) the sheet is in the corners of the opening than on average, as a fraction; its middle is softer. 0 is even heating.")
          .group(group_title)
          .advanced(),
      parameter(
          "thickness_wedge_x", &SheetEffects::thickness_wedge_x, "Thicker towards the right", unit::none, -0.9, 0.9,
          "How much thicker the flat sheet is at the right side of the opening than in its middle, as a fraction. 0.05 means 5 %; 0 is an even sheet.")
          .group(group_title)
          .advanced(),
      parameter(
          "thickness_wedge_y", &SheetEffects::thickness_wedge_y, "Thicker towards the back", unit::none, -0.9, 0.9,
          "How much thicker the flat sheet is at the back of the opening than in its middle, as a fraction. 0.05 means 5 %; 0 is an even sheet.")
          .group(group_title)
          .advanced(),
      parameter(
          "anisotropy", &SheetEffects::anisotropy, "Stiffer along x", unit::none, -0.9, 0.9,
          "How much stiffer the sheet is along x, and softer along y, as a fraction. Extruded sheets often differ between the two directions; 0 is equal.")
          .group(group_title)
          .advanced(),
      parameter(
          "slip", &SheetEffects::slip, "Sheet slides on the mould", unit::none, 0, 20,
          "How easily the sheet slides over the mould: 1 divided by the coefficient of friction. 0: it sticks wherever it touches; larger values slide more.")
          .group(group_title)
          .slider(0, 5)
          .advanced(),
      parameter(
          "cooling", &SheetEffects::cooling, "Sheet cools on touching", unit::none, 0, 10,
          "How much the cold mould stiffens the sheet where it touches, and within about 10 mm. 0: not at all; 1: six times as stiff within 0.1 s.")
          .group(group_title)
          .slider(0, 3)
          .advanced(),
      parameter("weak_vacuum", &SheetEffects::weak_vacuum, "Vacuum lost", unit::none, 0, 0.95,
                "Fraction of the vacuum that leaks away. 0: no leak; 0.3 leaves 70 %.")
          .group(group_title)
          .advanced(),
      parameter(
          "clamp_slip_mm", &SheetEffects::clamp_slip_mm, "Sheet slips in the clamp", unit::mm, 0, 20,
          "How far the sheet's rim is pulled in from under the clamp while the model rises, where it is pulled hardest all the time; elsewhere less. 0: the clamp holds.")
          .group(group_title)
          .slider(0, 5)
          .advanced(),
      parameter("mould_shift_x_mm", &SheetEffects::mould_shift_x_mm, "Mould misplaced in x", unit::mm, -50, 50,
                "How far the mould stands to the right of its intended place; negative is to the left.")
          .group(group_title)
          .slider(-5, 5)
          .advanced(),
      parameter("mould_shift_y_mm", &SheetEffects::mould_shift_y_mm, "Mould misplaced in y", unit::mm, -50, 50,
                "How far the mould stands behind its intended place; negative is in front of it.")
          .group(group_title)
          .slider(-5, 5)
          .advanced(),
      parameter(
          "mould_rotation_deg", &SheetEffects::mould_rotation_deg, "Mould rotated", unit::degrees, -180, 180,
          "Angle by which the mould is rotated from its intended position about the vertical axis through the centre of the opening, counter-clockwise seen from above.")
          .group(group_title)
          .slider(-10, 10)
          .advanced(),
      parameter(
          "mould_scale", &SheetEffects::mould_scale, "Mould too large by", unit::none, -0.5, 0.5,
          "How much larger the mould is than it should be, as a fraction: 0.01 is 1 %, negative is too small. It grows from the centre of the opening on the plate.")
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
