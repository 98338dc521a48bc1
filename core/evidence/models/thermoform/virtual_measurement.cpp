// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/models/thermoform/virtual_measurement.h"

#include "base/random.h"

namespace formwright {

std::vector<MeasuredPoint> scan_virtually(const FormedSheet& sheet, const ThermoformOptions& o, MeasuredSurface surface,
                                          const MeasurementEffects& effects, const VirtualScan& scan) {
  Random random(static_cast<std::uint64_t>(scan.seed));
  TextureCoordinates places(scan.points, 2);
  for (Eigen::Index i = 0; i < places.rows(); ++i) {
    places(i, 0) = random.uniform(-0.49, 0.49) * o.clamp_opening_x_mm;
    places(i, 1) = random.uniform(-0.49, 0.49) * o.clamp_opening_y_mm;
  }
  const Positions true_places =
      predict_measured(sheet, places, surface, o.clamp_height_mm, o.sheet_thickness_mm, effects, 0);
  constexpr double outlier_mm = 4;
  std::vector<MeasuredPoint> points;
  for (Eigen::Index i = 0; i < places.rows(); ++i) {
    Vec3 place = true_places.row(i).transpose();
    // Points are not equally good, and their stated uncertainty says so.
    const double sigma = scan.noise_mm * random.uniform(0.7, 1.4);
    for (int k = 0; k < 3; ++k) place[k] += sigma * random.normal();
    if (random.uniform() < 0.01 * scan.outlier_percent)
      for (int k = 0; k < 3; ++k) place[k] += outlier_mm * random.normal();
    points.push_back({places.row(i).transpose(), place, sigma});
  }
  return points;
}

}  // namespace formwright
