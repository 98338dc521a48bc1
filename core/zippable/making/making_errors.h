// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What goes wrong between a plan and the sewn ribbon: a simulation shows what it does, a plan makes up for it.
#include <Eigen/Core>
#include <tuple>

#include "base/data/parameters.h"

namespace formwright {

struct MakingErrors {
  static constexpr std::string_view group_title = "Errors of making";

  double plan_scale = 0;
  double cloth_stretch_along = 0, cloth_stretch_across = 0, cloth_bias = 0;
  double more_kerf_mm = 0, more_gap_mm = 0, seam_take_up_mm = 0;

  static constexpr auto parameters = std::tuple{
      parameter("plan_scale", &MakingErrors::plan_scale, "Plan cut at another size", unit::none, -0.2, 0.2,
                "0.01 where everything is cut 1 % too large. A plan makes up for it, a simulation shows it.")
          .slider(-0.05, 0.05)
          .group(group_title)
          .advanced(),
      parameter(
          "cloth_stretch_along", &MakingErrors::cloth_stretch_along, "Cloth longer along its grain", unit::none, -0.3,
          0.3,
          "0.02 where the cloth is 2 % longer, along x of the sheet, once it is cut; less than 0 where it shrinks. A plan makes up for it, a simulation shows it.")
          .slider(-0.1, 0.1)
          .group(group_title)
          .advanced(),
      parameter(
          "cloth_stretch_across", &MakingErrors::cloth_stretch_across, "Cloth longer across its grain", unit::none,
          -0.3, 0.3,
          "0.02 where the cloth is 2 % longer, along y of the sheet, once it is cut; less than 0 where it shrinks. A plan makes up for it, a simulation shows it.")
          .slider(-0.1, 0.1)
          .group(group_title)
          .advanced(),
      parameter(
          "cloth_bias", &MakingErrors::cloth_bias, "Cloth pulled askew", unit::none, -0.2, 0.2,
          "Half of the angle, in radians, by which a right angle between x and y of the sheet closes once it is cut. A plan makes up for it, a simulation shows it.")
          .slider(-0.1, 0.1)
          .group(group_title)
          .advanced(),
      parameter("more_kerf_mm", &MakingErrors::more_kerf_mm, "Kerf beyond the plan's", unit::mm, -5, 5,
                "How much more the cut removes than the plan's kerf. A plan makes up for it, a simulation shows it.")
          .slider(-1, 1)
          .group(group_title)
          .advanced(),
      parameter(
          "more_gap_mm", &MakingErrors::more_gap_mm, "Zipper wider than planned", unit::mm, -10, 10,
          "How much wider the closed zipper holds both edges apart than the plan allows for. A plan makes up for it, a simulation shows it.")
          .slider(-4, 4)
          .group(group_title)
          .advanced(),
      parameter(
          "seam_take_up_mm", &MakingErrors::seam_take_up_mm, "Cloth lost in seams", unit::mm, -10, 10,
          "Width of cloth that disappears under the zipper at each of both edges beyond the plan. A plan makes up for it, a simulation shows it.")
          .slider(0, 5)
          .group(group_title)
          .advanced()};

  /// How far each edge along the zipper lies outside of where it was designed.
  double edge_shift_mm() const { return 0.5 * more_gap_mm - seam_take_up_mm - 0.5 * more_kerf_mm; }
  /// From the plan, in the sheet's coordinates, to the cloth as it lies after cutting.
  Eigen::Matrix2d cloth_change() const {
    Eigen::Matrix2d change;
    change << 1 + cloth_stretch_along, cloth_bias, cloth_bias, 1 + cloth_stretch_across;
    return (1 + plan_scale) * change;
  }
  bool changes_the_cloth() const { return cloth_change() != Eigen::Matrix2d::Identity(); }
};

}  // namespace formwright
