// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/models/thermoform/virtual_measurement.h"

#include <algorithm>

#include "base/random.h"

namespace formwright {
namespace {

TextureCoordinates random_places(Random& random, int count, const ThermoformOptions& o) {
  TextureCoordinates places(count, 2);
  for (Eigen::Index i = 0; i < places.rows(); ++i) {
    places(i, 0) = random.uniform(-0.49, 0.49) * o.clamp_opening_x_mm;
    places(i, 1) = random.uniform(-0.49, 0.49) * o.clamp_opening_y_mm;
  }
  return places;
}

}  // namespace

std::vector<MeasuredPoint> scan_virtually(const FormedSheet& sheet, const ThermoformOptions& o, MeasuredSurface surface,
                                          const MeasurementEffects& effects, const VirtualScan& scan) {
  Random random(static_cast<std::uint64_t>(scan.seed));
  const TextureCoordinates places = random_places(random, scan.points, o);
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

std::vector<MeasuredThickness> gauge_virtually(const FormedSheet& sheet, const ThermoformOptions& o,
                                               const MeasurementEffects& effects, const VirtualScan& scan) {
  constexpr std::uint64_t of_thickness = 1ULL << 32;  // beyond any seed: the points are the same with and without
  Random random(of_thickness + static_cast<std::uint64_t>(scan.seed));
  const TextureCoordinates places = random_places(random, scan.thickness_points, o);
  const Eigen::VectorXd thickness = predict_thickness(sheet, places, o, effects);
  constexpr double min_reading_mm = 0.005;  // the finest that a gauge shows
  std::vector<MeasuredThickness> readings;
  for (Eigen::Index i = 0; i < places.rows(); ++i)
    readings.push_back({places.row(i).transpose(),
                        std::max(min_reading_mm, thickness[i] + scan.thickness_noise_mm * random.normal()),
                        scan.thickness_noise_mm});
  return readings;
}

}  // namespace formwright
