// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What printing the pattern and scanning the object add to what the machine did. 0 where absent.
#include <Eigen/Geometry>
#include <numbers>
#include <tuple>

#include "base/data/parameters.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// How much larger than intended the printer prints: of whatever has such a member.
template <class Options>
constexpr auto print_scale_parameter(double Options::*member, std::string_view group) {
  return parameter(
             "print_scale", member, "Print too large by", unit::none, -0.2, 0.2,
             "How much larger than intended the printer prints, as a fraction: 0.01 is 1 %, negative is too small. Measure a long line of a print to know it.")
      .group(group)
      .slider(-0.05, 0.05)
      .advanced();
}

/// How much longer along one side alone, on top of print_scale.
template <class Options>
constexpr auto print_stretch_parameters(double Options::*x, double Options::*y, std::string_view group) {
  return std::tuple{
      parameter(
          "print_stretch_x", x, "Print stretched from side to side by", unit::none, -0.2, 0.2,
          "How much too long the printer prints from side to side alone, as a fraction: 0.01 is 1 %, negative is too short. Rollers that push the paper on a little too far do that.")
          .group(group)
          .slider(-0.05, 0.05)
          .advanced(),
      parameter(
          "print_stretch_y", y, "Print stretched from front to back by", unit::none, -0.2, 0.2,
          "How much too long the printer prints from front to back alone, as a fraction: 0.01 is 1 %, negative is too short.")
          .group(group)
          .slider(-0.05, 0.05)
          .advanced()};
}

/// How many times as long as intended the printer prints along x and y.
inline Vec2 print_factors(double scale, double stretch_x, double stretch_y) {
  return (1 + scale) * Vec2(1 + stretch_x, 1 + stretch_y);
}

struct MeasurementEffects {
  static constexpr std::string_view group_title = "Measurement faults";

  double print_scale = 0;
  double print_stretch_x = 0;
  double print_stretch_y = 0;
  double scan_scale = 0;
  double scan_stretch_x = 0;
  double scan_stretch_y = 0;
  double scan_stretch_z = 0;
  double scan_turn_x_deg = 0;
  double scan_turn_y_deg = 0;
  double scan_turn_z_deg = 0;
  double scan_shift_x_mm = 0;
  double scan_shift_y_mm = 0;
  double scan_shift_z_mm = 0;

  /// The true place on the sheet of what measured.csv has at `printed_mm`.
  Vec2 on_sheet(const Vec2& printed_mm) const {
    return print_factors(print_scale, print_stretch_x, print_stretch_y).cwiseProduct(printed_mm);
  }

  /// measured = turn (1 + scale) (1 + stretch) true + shift, of places from the middle of the opening on the raised
  /// base plate.
  Eigen::Affine3d scan() const {
    constexpr double per_degree = std::numbers::pi / 180;
    Eigen::Affine3d scan(Eigen::Translation3d(scan_shift_x_mm, scan_shift_y_mm, scan_shift_z_mm));
    scan.rotate(Eigen::AngleAxisd(per_degree * scan_turn_z_deg, Vec3::UnitZ()) *
                Eigen::AngleAxisd(per_degree * scan_turn_y_deg, Vec3::UnitY()) *
                Eigen::AngleAxisd(per_degree * scan_turn_x_deg, Vec3::UnitX()));
    scan.scale((1 + scan_scale) * Vec3(1 + scan_stretch_x, 1 + scan_stretch_y, 1 + scan_stretch_z));
    return scan;
  }

  static constexpr auto parameters = std::tuple_cat(
      std::tuple{print_scale_parameter(&MeasurementEffects::print_scale, group_title)},
      print_stretch_parameters(&MeasurementEffects::print_stretch_x, &MeasurementEffects::print_stretch_y, group_title),
      std::tuple{
          parameter(
              "scan_scale", &MeasurementEffects::scan_scale, "Scan too large by", unit::none, -0.2, 0.2,
              "How much larger than the object the scan is, as a fraction: 0.01 is 1 %, negative is too small. It grows from the centre of the opening on the plate.")
              .group(group_title)
              .slider(-0.05, 0.05)
              .advanced(),
          parameter(
              "scan_stretch_x", &MeasurementEffects::scan_stretch_x, "Scan stretched from side to side by", unit::none,
              -0.2, 0.2,
              "How much too long the scan is from side to side alone, as a fraction: 0.01 is 1 %, negative is too short. A scanner that moves past the object a little too slowly does that.")
              .group(group_title)
              .slider(-0.05, 0.05)
              .advanced(),
          parameter(
              "scan_stretch_y", &MeasurementEffects::scan_stretch_y, "Scan stretched from front to back by", unit::none,
              -0.2, 0.2,
              "How much too long the scan is from front to back alone, as a fraction: 0.01 is 1 %, negative is too short.")
              .group(group_title)
              .slider(-0.05, 0.05)
              .advanced(),
          parameter("scan_stretch_z", &MeasurementEffects::scan_stretch_z, "Scan stretched in height by", unit::none,
                    -0.2, 0.2,
                    "How much too long the scan is in height alone, as a fraction: 0.01 is 1 %, negative is too short.")
              .group(group_title)
              .slider(-0.05, 0.05)
              .advanced(),
          parameter(
              "scan_turn_x_deg", &MeasurementEffects::scan_turn_x_deg, "Scan turned about x", unit::degrees, -45, 45,
              "How far the scan is turned about the x axis: where it is positive, the back lies too high and the front too low.")
              .group(group_title)
              .slider(-5, 5)
              .advanced(),
          parameter(
              "scan_turn_y_deg", &MeasurementEffects::scan_turn_y_deg, "Scan turned about y", unit::degrees, -45, 45,
              "How far the scan is turned about the y axis: where it is positive, the left lies too high and the right too low.")
              .group(group_title)
              .slider(-5, 5)
              .advanced(),
          parameter("scan_turn_z_deg", &MeasurementEffects::scan_turn_z_deg, "Scan turned about z", unit::degrees, -45,
                    45, "How far the scan is turned counter-clockwise, seen from above.")
              .group(group_title)
              .slider(-5, 5)
              .advanced(),
          parameter("scan_shift_x_mm", &MeasurementEffects::scan_shift_x_mm, "Scan misplaced in x", unit::mm, -100, 100,
                    "How far the scan lies to the right of the true position; negative is to the left.")
              .group(group_title)
              .slider(-5, 5)
              .advanced(),
          parameter("scan_shift_y_mm", &MeasurementEffects::scan_shift_y_mm, "Scan misplaced in y", unit::mm, -100, 100,
                    "How far the scan lies behind the true position; negative is in front of it.")
              .group(group_title)
              .slider(-5, 5)
              .advanced(),
          parameter("scan_shift_z_mm", &MeasurementEffects::scan_shift_z_mm, "Scan misplaced in z", unit::mm, -100, 100,
                    "How far the scan lies above the true position; negative is below it.")
              .group(group_title)
              .slider(-5, 5)
              .advanced()});
};

}  // namespace formwright
