// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/fit/noise_model.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/statistics.h"
#include "base/random.h"
#include "evidence/fit/structured_misfit.h"

namespace formwright {
namespace {

/// Median of chi-square with d degrees of freedom (Wilson and Hilferty).
double chi_square_median(double d) { return d * std::pow(1 - 2 / (9 * d), 3); }

constexpr double outlier_limit = 5;  // standard deviations, of the residual's length against its median

}  // namespace

double largest_noise(const ForwardModel& model, const std::vector<NoiseEstimate>& noise) {
  double largest = 0;
  for (std::size_t m = 0; m < noise.size(); ++m)
    if (model.measurements()[m].is_place()) largest = std::max(largest, noise[m].sigma);
  return largest;
}

NoiseEstimate estimate_noise(const Measurement& measurement, const Eigen::MatrixXd& residual) {
  const Eigen::Index n = residual.rows(), d = residual.cols();
  NoiseEstimate result;
  const bool stated = measurement.sigma.maxCoeff() > 0;
  Eigen::VectorXd sigma = Eigen::VectorXd::Ones(n);
  if (stated) {
    std::vector<double> known;
    double squares = 0;
    for (const double own : measurement.sigma)
      if (own > 0) known.push_back(own), squares += own * own;
    result.stated_sigma = std::sqrt(squares / static_cast<double>(known.size()));
    const double usual = median(known);
    // 0 means that it is not known: as good as the others. No point is ten times as good as these.
    for (Eigen::Index i = 0; i < n; ++i)
      sigma[i] = measurement.sigma[i] > 0 ? std::max(measurement.sigma[i], 0.1 * result.stated_sigma) : usual;
  }
  if (stated && n < min_points_to_find_noise) {
    result.weights = sigma.array().square().inverse();
    result.sigma = std::sqrt(sigma.array().square().mean());
    return result;
  }

  // Smooth part and scale by turns, with weights as of Student's t, so that outliers bend neither.
  Eigen::VectorXd trust = Eigen::VectorXd::Ones(n);
  Eigen::VectorXd normalised(n);
  double scale = 0;
  {
    std::vector<double> lengths(static_cast<std::size_t>(n));
    for (Eigen::Index i = 0; i < n; ++i)
      lengths[static_cast<std::size_t>(i)] = residual.row(i).squaredNorm() / (sigma[i] * sigma[i]);
    scale = std::sqrt(std::max(1e-12, median(lengths) / chi_square_median(static_cast<double>(d))));
  }
  for (int round = 0; round < 8; ++round) {
    const Eigen::VectorXd weights = (trust.array() / (scale * sigma.array()).square()).matrix();
    const double size = std::sqrt(residual.squaredNorm() / static_cast<double>(n * d));
    const StructuredMisfit structure(measurement, isotropic(weights, 1), {std::max(size, 1e-9)});
    Eigen::MatrixXd noise = residual;
    for (Eigen::Index c = 0; c < d; ++c) noise.col(c) -= structure.smooth(residual.col(c), 0);
    const Eigen::VectorXd leverage = structure.leverage(0);
    std::vector<double> squares;
    for (Eigen::Index i = 0; i < n; ++i) {
      normalised[i] = noise.row(i).squaredNorm() / (sigma[i] * sigma[i] * std::max(0.05, 1 - leverage[i]));
      squares.push_back(normalised[i]);
    }
    scale = std::sqrt(std::max(1e-12, median(squares) / chi_square_median(static_cast<double>(d))));
    constexpr double degrees_of_student = 4;
    for (Eigen::Index i = 0; i < n; ++i)
      trust[i] = std::min(
          1.0, (degrees_of_student + static_cast<double>(d)) / (degrees_of_student + normalised[i] / (scale * scale)));
  }
  result.weights.resize(n);
  const double limit = std::pow(outlier_limit, 2) * static_cast<double>(d) * scale * scale / 2;
  double sum = 0;
  int good = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const bool outlier = normalised[i] > limit;
    result.outliers += outlier;
    result.weights[i] = outlier ? 0 : trust[i] / std::pow(scale * sigma[i], 2);
    if (outlier) continue;
    sum += std::pow(scale * sigma[i], 2);
    ++good;
  }
  result.sigma = good > 0 ? std::sqrt(sum / good) : 0;
  result.scale = stated ? scale : 1;
  return result;
}

Eigen::MatrixXd model_covariance(const Measurement& measurement, const std::vector<Eigen::MatrixXd>& movements) {
  constexpr double share = 0.5;  // of a movement that stays even where its direction is accounted for
  constexpr int cells = 24;
  const Eigen::Index n = measurement.measured.rows(), d = measurement.measured.cols();
  Eigen::MatrixXd own = Eigen::MatrixXd::Zero(n, d * d);
  for (const Eigen::MatrixXd& movement : movements)
    for (Eigen::Index p = 0; p < d; ++p)
      for (Eigen::Index q = 0; q < d; ++q)
        own.col(p * d + q) += share * share * movement.col(p).cwiseProduct(movement.col(q));
  // Necks move: what happens to a point may as well happen to its neighbours.
  std::vector<Eigen::MatrixXd> sum(static_cast<std::size_t>((cells + 2) * (cells + 2)),
                                   Eigen::MatrixXd::Zero(1, d * d));
  std::vector<double> count(sum.size(), 0);
  const auto cell = [&](Eigen::Index i, int k) {
    return 1 + std::clamp(static_cast<int>(cells * measurement.place(i, k)), 0, cells - 1);
  };
  const auto at = [&](int x, int y) { return static_cast<std::size_t>((cells + 2) * y + x); };
  for (Eigen::Index i = 0; i < n; ++i) {
    sum[at(cell(i, 0), cell(i, 1))] += own.row(i);
    count[at(cell(i, 0), cell(i, 1))] += 1;
  }
  const auto trace = [&](const auto& block) {
    double t = 0;
    for (Eigen::Index c = 0; c < d; ++c) t += block(0, c * d + c);
    return t;
  };
  Eigen::MatrixXd covariance = own;
  for (Eigen::Index i = 0; i < n; ++i) {
    Eigen::MatrixXd around = Eigen::MatrixXd::Zero(1, d * d);
    double points = 0;
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y) {
        around += sum[at(cell(i, 0) + x, cell(i, 1) + y)];
        points += count[at(cell(i, 0) + x, cell(i, 1) + y)];
      }
    around /= points;
    if (trace(around) > trace(own.row(i))) covariance.row(i) = around;
  }
  return covariance;
}

StructureTest test_structure(const Measurement& measurement, const Eigen::MatrixXd& residual,
                             const Eigen::VectorXd& weights) {
  StructureTest test;
  std::vector<Eigen::Index> used;
  for (Eigen::Index i = 0; i < weights.size(); ++i)
    if (weights[i] > 0) used.push_back(i);
  const auto n = static_cast<Eigen::Index>(used.size());
  if (n < 10) return test;
  Eigen::MatrixXd r(n, residual.cols());
  for (Eigen::Index i = 0; i < n; ++i)
    r.row(i) = residual.row(used[static_cast<std::size_t>(i)]) * std::sqrt(weights[used[static_cast<std::size_t>(i)]]);
  const double variance = r.squaredNorm() / static_cast<double>(n);
  if (!(variance > 0)) return test;

  // A grid of cells finds pairs of points by distance.
  const int cells = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(n) / 2)), 2, 64);
  std::vector<std::vector<Eigen::Index>> members(static_cast<std::size_t>(cells * cells));
  const auto cell_of = [&](double t) { return std::clamp(static_cast<int>(t * cells), 0, cells - 1); };
  std::vector<std::array<int, 2>> cell(static_cast<std::size_t>(n));
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto place = measurement.place.row(used[static_cast<std::size_t>(i)]);
    cell[static_cast<std::size_t>(i)] = {cell_of(place[0]), cell_of(place[1])};
    members[static_cast<std::size_t>(cell[static_cast<std::size_t>(i)][0] * cells +
                                     cell[static_cast<std::size_t>(i)][1])]
        .push_back(i);
  }
  // Neighbours: the nearest other point in the same or an adjoining cell.
  std::vector<std::pair<Eigen::Index, Eigen::Index>> neighbours;
  for (Eigen::Index i = 0; i < n; ++i) {
    Eigen::Index nearest = -1;
    double best = 1e300;
    const auto [cx, cy] = cell[static_cast<std::size_t>(i)];
    for (int x = std::max(0, cx - 1); x <= std::min(cells - 1, cx + 1); ++x)
      for (int y = std::max(0, cy - 1); y <= std::min(cells - 1, cy + 1); ++y)
        for (const Eigen::Index j : members[static_cast<std::size_t>(x * cells + y)]) {
          const double distance = (measurement.place.row(used[static_cast<std::size_t>(i)]) -
                                   measurement.place.row(used[static_cast<std::size_t>(j)]))
                                      .squaredNorm();
          if (j != i && distance < best) best = distance, nearest = j;
        }
    if (nearest >= 0) neighbours.emplace_back(i, nearest);
  }
  if (neighbours.empty()) return test;
  const auto correlation = [&](const std::vector<Eigen::Index>& order) {
    double sum = 0;
    for (const auto& [i, j] : neighbours)
      sum += r.row(order[static_cast<std::size_t>(i)]).dot(r.row(order[static_cast<std::size_t>(j)]));
    return sum / static_cast<double>(neighbours.size()) / variance;
  };
  std::vector<Eigen::Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  test.neighbour_correlation = correlation(order);
  constexpr int permutations = 199;
  Random random(1);
  int as_large = 0;
  for (int k = 0; k < permutations; ++k) {
    for (std::size_t i = order.size() - 1; i > 0; --i) std::swap(order[i], order[random.below(i + 1)]);
    as_large += correlation(order) >= test.neighbour_correlation;
  }
  test.p_value = (1.0 + as_large) / (1.0 + permutations);

  // Correlogram in bins of distance, from a subset of the pairs.
  constexpr int bins = 20;
  constexpr double longest = 0.5;
  std::array<double, bins> sum{};
  std::array<int, bins> count{};
  const Eigen::Index stride = std::max<Eigen::Index>(1, n / 700);
  for (Eigen::Index i = 0; i < n; i += stride)
    for (Eigen::Index j = 0; j < i; j += stride) {
      const double distance = (measurement.place.row(used[static_cast<std::size_t>(i)]) -
                               measurement.place.row(used[static_cast<std::size_t>(j)]))
                                  .norm();
      const int bin = static_cast<int>(distance / longest * bins);
      if (bin >= bins) continue;
      sum[static_cast<std::size_t>(bin)] += r.row(i).dot(r.row(j)) / variance;
      ++count[static_cast<std::size_t>(bin)];
    }
  const double start = std::max(test.neighbour_correlation, 1e-6);
  for (int bin = 0; bin < bins; ++bin) {
    const auto b = static_cast<std::size_t>(bin);
    if (count[b] < 5) continue;
    if (sum[b] / count[b] < start / std::numbers::e) break;
    test.correlation_length_mm = (bin + 0.5) / bins * longest * measurement.extent_mm;
  }
  return test;
}

}  // namespace formwright
