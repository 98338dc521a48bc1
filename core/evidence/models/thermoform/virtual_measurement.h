// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Measuring a simulated sheet as a scan would: to rehearse a diagnosis with a machine whose faults are known.
#include "thermoform/measured/measured_object.h"
#include "thermoform/measured/measured_thickness.h"
#include "thermoform/sheet/thermoform_options.h"

namespace formwright {

struct VirtualScan {
  int points = 1200;
  double noise_mm = 0.05;      // standard deviation of one coordinate, about: points are not equally good
  double outlier_percent = 2;  // points that are off by some 4 mm
  int seed = 1;
  int thickness_points = 0;
  double thickness_noise_mm = usual_thickness_sigma_mm;

  static constexpr std::string_view group_title = "Virtual scan";
  static constexpr auto parameters = std::tuple{
      parameter("points", &VirtualScan::points, "Points", unit::none, 30, 100000,
                "Number of points that the virtual scan measures, spread over the whole sheet.")
          .group(group_title)
          .slider(200, 5000),
      parameter(
          "noise_mm", &VirtualScan::noise_mm, "Noise", unit::mm, 0, 5,
          "Standard deviation of the random error added to each coordinate of a measured point. 0.05 mm is usual.")
          .group(group_title)
          .slider(0, 0.3),
      parameter("outlier_percent", &VirtualScan::outlier_percent, "Outliers", unit::percent, 0, 30,
                "Share of points that are measured far off, as wrongly matched points are.")
          .group(group_title)
          .slider(0, 10),
      parameter("seed", &VirtualScan::seed, "Seed", unit::none, 0, 1000000,
                "Number that selects the random points and errors. The same number gives the same measurement again.")
          .group(group_title),
      parameter(
          "thickness_points", &VirtualScan::thickness_points, "Thickness readings", unit::none, 0, 10000,
          "Number of places at which the virtual scan also measures how thick the formed sheet is. Three are enough to be of use; 0 measures none.")
          .group(group_title)
          .slider(0, 30),
      parameter("thickness_noise_mm", &VirtualScan::thickness_noise_mm, "Noise of the thickness", unit::mm, 0.001, 1,
                "Standard deviation of the random error added to each thickness reading. 0.05 mm is usual.")
          .group(group_title)
          .slider(0.01, 0.2)};
};

/// Points of `sheet` (raised base plate at z = 0) as a scan has them, `o` being what it was formed with. The same seed
/// gives the same points.
std::vector<MeasuredPoint> scan_virtually(const FormedSheet& sheet, const ThermoformOptions& o, MeasuredSurface surface,
                                          const MeasurementEffects& effects, const VirtualScan& scan);

/// Thickness readings of the same scan, at places of their own.
std::vector<MeasuredThickness> gauge_virtually(const FormedSheet& sheet, const ThermoformOptions& o,
                                               const MeasurementEffects& effects, const VirtualScan& scan);

}  // namespace formwright
