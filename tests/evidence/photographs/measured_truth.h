// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Virtual photographs measured, and compared with what they were made from.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/statistics.h"
#include "evidence/photographs/photograph_measurement.h"
#include "evidence/photographs/photograph_studio.h"

namespace formwright::test {

struct Taken {
  std::vector<Bytes> files;
  std::vector<Photograph> photographs;
};

inline Taken take_photographs(const Scene& scene, const Phone& phone, const std::vector<View>& views,
                              std::uint64_t seed = 1) {
  Taken taken;
  for (std::size_t i = 0; i < views.size(); ++i) taken.files.push_back(photograph(scene, phone, views[i], seed + i));
  for (std::size_t i = 0; i < views.size(); ++i)
    taken.photographs.push_back({i == 0 ? "photograph" : "photograph_" + std::to_string(i + 1),
                                 "photo" + std::to_string(i + 1) + ".jpg", taken.files[i]});
  return taken;
}

inline PhotographOptions options_of(const Scene& scene) {
  PhotographOptions options;
  options.board_height_mm = scene.board_z_mm;
  options.board_check_sigma_mm = 0;
  return options;
}

struct TruthError {
  std::size_t points = 0;
  double median_mm = 0, percentile_95_mm = 0, max_mm = 0;
  double chi_square = 0;      // mean of squared errors over sigma, per direction; 1 is honest
  double within_2_sigma = 0;  // share of the points within 2 sigma sqrt(3) of the truth
};

inline TruthError truth_error(const PhotographMeasurement& m, const Bump& bump) {
  std::vector<double> errors;
  TruthError result;
  double inside = 0;
  for (const PhotographedPoint& p : m.points) {
    const double error = (p.place_mm - bump.place_mm(p.sheet_mm)).norm();
    errors.push_back(error);
    result.chi_square += error * error / (3 * p.sigma_mm * p.sigma_mm);
    inside += error < 2 * std::sqrt(3.0) * p.sigma_mm ? 1 : 0;
  }
  result.points = errors.size();
  if (errors.empty()) return result;
  const auto count = static_cast<double>(errors.size());
  result.chi_square /= count;
  result.within_2_sigma = inside / count;
  result.median_mm = median(errors);
  result.percentile_95_mm = quantile(errors, 0.95);
  result.max_mm = *std::max_element(errors.begin(), errors.end());
  return result;
}

}  // namespace formwright::test
