// SPDX-License-Identifier: GPL-3.0-or-later
#include "imaging/colour/colour_correction.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/statistics.h"
#include "base/error.h"
#include "formats/shared/colour.h"

namespace formwright {
namespace {

constexpr int rounds = 25;

std::array<double, 5> light_terms(const Vec2& p) { return {p.x(), p.y(), p.x() * p.x(), p.x() * p.y(), p.y() * p.y()}; }

/// Grey levels of sRGB per unit of linear light, about a colour: what the eye and the flow see.
double levels_per_light(double linear) { return 255 / (2.4 * std::pow(std::max(linear, 0.004), 1 - 1 / 2.4)); }

}  // namespace

double ColourCorrection::light(const Vec2& place) const {
  const auto terms = light_terms(place);
  double exponent = 0;
  for (std::size_t k = 0; k < 5; ++k) exponent += log_light[k] * terms[k];
  return std::exp(std::clamp(exponent, -3.0, 3.0));
}

ColourCorrection fit_colour_correction(std::span<const ColourSample> samples) {
  if (samples.size() < 8)
    throw Error(ErrorCode::could_not_solve, "",
                "Too few colour patches are visible to correct the colours: scan the whole sheet.");
  const bool full = samples.size() >= 12, lit = samples.size() >= 30;
  ColourCorrection fit;
  // Unknowns: rows of the matrix, offset, logarithm of the light. Gauss-Newton from the means; weights from the
  // residuals so far.
  Vec3 seen = Vec3::Zero(), expected = Vec3::Zero();
  for (const ColourSample& s : samples) {
    seen += s.seen;
    expected += s.expected;
  }
  if (!(seen.minCoeff() > 1e-9))
    throw Error(ErrorCode::could_not_solve, "",
                "The scan's picture is black where the colour patches should be: check the positions of the corners.");
  fit.matrix = expected.cwiseQuotient(seen).asDiagonal();
  std::vector<double> weights(samples.size(), 1);
  constexpr int unknowns = 17;
  for (int round = 0; round < rounds; ++round) {
    Eigen::Matrix<double, unknowns, unknowns> normal = Eigen::Matrix<double, unknowns, unknowns>::Zero();
    Eigen::Matrix<double, unknowns, 1> right = Eigen::Matrix<double, unknowns, 1>::Zero();
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const ColourSample& s = samples[i];
      const Vec3 even = s.seen / fit.light(s.place), residual = s.expected - fit(s.seen, s.place),
                 slope = fit.matrix * even;
      const auto terms = light_terms(s.place);
      for (int c = 0; c < 3; ++c) {
        const double gain = levels_per_light(s.expected[c]);
        Eigen::Matrix<double, unknowns, 1> row = Eigen::Matrix<double, unknowns, 1>::Zero();
        for (int k = 0; k < 3; ++k) row[3 * c + k] = full || k == c ? even[k] : 0;
        row[9 + c] = 1;
        if (lit)
          for (int k = 0; k < 5; ++k) row[12 + k] = -slope[c] * terms[static_cast<std::size_t>(k)];
        normal += weights[i] * gain * gain * row * row.transpose();
        right += weights[i] * gain * gain * row * residual[c];
      }
    }
    // A little of the identity holds what the samples do not speak about where it is.
    normal.diagonal().array() += 1e-6 * normal.diagonal().maxCoeff() + 1e-12;
    const Eigen::Matrix<double, unknowns, 1> step = normal.ldlt().solve(right);
    if (!step.allFinite())
      throw Error(ErrorCode::could_not_solve, "",
                  "The colours could not be corrected: the patches of the scan have no contrast.");
    for (int c = 0; c < 3; ++c) {
      for (int k = 0; k < 3; ++k) fit.matrix(c, k) += step[3 * c + k];
      fit.offset[c] += step[9 + c];
    }
    for (int k = 0; k < 5; ++k) fit.log_light[static_cast<std::size_t>(k)] += step[12 + k];
    std::vector<double> miss(samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const Vec3 r = samples[i].expected - fit(samples[i].seen, samples[i].place);
      double squared = 0;
      for (int c = 0; c < 3; ++c) squared += std::pow(r[c] * levels_per_light(samples[i].expected[c]), 2);
      miss[i] = std::sqrt(squared / 3);
    }
    const double limit = 4.685 * std::max(1.4826 * median(miss), 0.5);
    double sum = 0, kept = 0;
    fit.rejected = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double share = miss[i] / limit;
      weights[i] = share < 1 ? (1 - share * share) * (1 - share * share) : 0;
      if (share >= 1) ++fit.rejected;
      else {
        sum += miss[i] * miss[i];
        ++kept;
      }
    }
    fit.rms_levels = kept > 0 ? std::sqrt(sum / kept) : 0;
  }
  return fit;
}

}  // namespace formwright
