// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/local_kriging.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "base/parallel.h"

namespace formwright {
namespace {

constexpr std::size_t neighbours = 12;
constexpr Eigen::Index max_judged = 2000;
constexpr double outlier = 6;          // times the median error
constexpr double max_distance = 1e-3;  // of a place that is the same as a known one, of the extent
constexpr double lengths[] = {0.02, 0.04, 0.08, 0.16, 0.32, 0.64};  // of the extent
constexpr double noises[] = {0.03, 0.1, 0.3, 0.6, 0.9};

}  // namespace

LocalKriging::LocalKriging(const Eigen::MatrixX2d& place, const Eigen::MatrixXd& value) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(place.rows()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](Eigen::Index a, Eigen::Index b) { return place(a, 0) < place(b, 0); });
  const auto take = [&](const std::vector<Eigen::Index>& rows) {
    Eigen::MatrixX2d at(static_cast<Eigen::Index>(rows.size()), 2);
    Eigen::MatrixXd known(at.rows(), value.cols());
    for (Eigen::Index i = 0; i < at.rows(); ++i) {
      at.row(i) = place.row(rows[static_cast<std::size_t>(i)]);
      known.row(i) = value.row(rows[static_cast<std::size_t>(i)]);
    }
    place_ = std::move(at);
    value_ = std::move(known);
  };
  take(order);
  if (place_.rows() < 2) return;
  const double extent = std::max((place_.colwise().maxCoeff() - place_.colwise().minCoeff()).maxCoeff(), 1e-12);
  const auto choose = [&] {
    double least = mean_error(nullptr);
    smooth_ = false;
    for (const double length : lengths)
      for (const double noise : noises) {
        const Model model{length * extent, noise};
        const double error = mean_error(&model);
        if (!(error < least)) continue;
        least = error;
        model_ = model;
        smooth_ = true;
      }
    // What is known nowhere else is read where it is known: a field of short reach, without noise.
    if (!smooth_) model_ = {max_distance * extent, 0};
  };
  choose();
  if (!smooth_) return;
  const std::vector<double> errors = errors_of(&model_, 1);
  std::vector<double> sorted = errors;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
  const double max_error = outlier * sorted[sorted.size() / 2];
  std::vector<Eigen::Index> kept;
  for (std::size_t i = 0; i < errors.size(); ++i)
    if (errors[i] <= max_error) kept.push_back(order[i]);
  outliers_ = static_cast<int>(errors.size() - kept.size());
  if (outliers_ == 0) return;
  take(kept);
  choose();
}

std::vector<int> LocalKriging::nearest(const Eigen::RowVector2d& at, int left_out) const {
  // Outwards from where `at` would be in the order of x, until nothing farther along x can be nearer.
  struct Near {
    double squared;
    int row;
    bool operator<(const Near& other) const {
      return squared != other.squared ? squared < other.squared : row < other.row;
    }
  };
  std::vector<Near> best;
  const auto offer = [&](int row) {
    if (row == left_out) return;
    const Near near{(place_.row(row) - at).squaredNorm(), row};
    if (best.size() == neighbours && !(near < best.back())) return;
    best.insert(std::upper_bound(best.begin(), best.end(), near), near);
    if (best.size() > neighbours) best.pop_back();
  };
  const auto too_far = [&](int row) {
    const double along = place_(row, 0) - at.x();
    return best.size() == neighbours && along * along > best.back().squared;
  };
  const double* const begin = place_.data();
  const int n = static_cast<int>(place_.rows());
  int right = static_cast<int>(std::lower_bound(begin, begin + n, at.x()) - begin), left = right - 1;
  while (true) {
    const bool go_right = right < n && !too_far(right), go_left = left >= 0 && !too_far(left);
    if (!go_right && !go_left) break;
    if (go_right) offer(right++);
    if (go_left) offer(left--);
  }
  std::vector<int> rows;
  for (const Near& near : best) rows.push_back(near.row);
  return rows;
}

Eigen::RowVectorXd LocalKriging::read_one(const Eigen::RowVector2d& at, const std::vector<int>& from,
                                          const Model& model) const {
  const auto k = static_cast<Eigen::Index>(from.size());
  Eigen::MatrixXd among(k, k), values(k, value_.cols());
  Eigen::VectorXd to(k);
  const double signal = 1 - model.noise;
  for (Eigen::Index i = 0; i < k; ++i) {
    const Eigen::RowVector2d own = place_.row(from[static_cast<std::size_t>(i)]);
    values.row(i) = value_.row(from[static_cast<std::size_t>(i)]);
    to[i] = signal * std::exp(-(own - at).norm() / model.length);
    for (Eigen::Index j = 0; j <= i; ++j)
      among(i, j) = signal * std::exp(-(own - place_.row(from[static_cast<std::size_t>(j)])).norm() / model.length);
    // A trifle of noise lets two readings of one place differ.
    among(i, i) += std::max(model.noise, 1e-6);
  }
  return among.selfadjointView<Eigen::Lower>().llt().solve(to).transpose() * values;
}

std::vector<double> LocalKriging::errors_of(const Model* model, Eigen::Index stride) const {
  std::vector<double> errors(static_cast<std::size_t>((place_.rows() + stride - 1) / stride));
  parallel_for(errors.size(), 128, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Eigen::Index row = stride * static_cast<Eigen::Index>(i);
      Eigen::RowVectorXd left = value_.row(row);
      if (model != nullptr) left -= read_one(place_.row(row), nearest(place_.row(row), static_cast<int>(row)), *model);
      errors[i] = left.norm();
    }
  });
  return errors;
}

double LocalKriging::mean_error(const Model* model) const {
  const std::vector<double> errors = errors_of(model, (place_.rows() + max_judged - 1) / max_judged);
  return std::accumulate(errors.begin(), errors.end(), 0.0) / static_cast<double>(errors.size());
}

Eigen::MatrixXd LocalKriging::read(const Eigen::MatrixX2d& at) const {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(at.rows(), value_.cols());
  if (place_.rows() == 0) return result;
  parallel_for(static_cast<std::size_t>(at.rows()), 128, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      result.row(row) = read_one(at.row(row), nearest(at.row(row), -1), model_);
    }
  });
  return result;
}

}  // namespace formwright
