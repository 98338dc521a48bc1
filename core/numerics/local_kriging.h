// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A field known at scattered places, read at others: kriging from the nearest few [Cre93].
#include <Eigen/Core>
#include <vector>

namespace formwright {

/// The field is Gaussian about zero with covariance exp(-distance / length), and noise on top. Far from what is known
/// it is zero, where much is known near by it is their smooth course, and at a known place nearly what was known there.
class LocalKriging {
 public:
  /// `place` (n x 2, any unit) and `value` (n x d), all finite; n may be 0. Length and share of noise are those of a
  /// grid that predict each value best from its neighbours (smallest mean distance of about 2,000 of them), zero
  /// everywhere among them. What is farther from its neighbours' prediction than six times the median is left out as an
  /// outlier.
  LocalKriging(const Eigen::MatrixX2d& place, const Eigen::MatrixXd& value);

  /// k x d, at `at` (k x 2).
  Eigen::MatrixXd read(const Eigen::MatrixX2d& at) const;

  /// False where no neighbour predicts its neighbours better than zero does: only known places are then read.
  bool is_smooth() const { return smooth_; }
  int outliers() const { return outliers_; }

 private:
  struct Model {
    double length, noise;  // noise: share of the variance
  };
  /// Of what is known, the nearest to `at`, without number `left_out`.
  std::vector<int> nearest(const Eigen::RowVector2d& at, int left_out) const;
  Eigen::RowVectorXd read_one(const Eigen::RowVector2d& at, const std::vector<int>& from, const Model& model) const;
  /// How far every `stride`-th value is from what its neighbours predict by `model`, or by null from zero.
  std::vector<double> errors_of(const Model* model, Eigen::Index stride) const;
  double mean_error(const Model* model) const;

  Eigen::MatrixX2d place_;  // ascending by x
  Eigen::MatrixXd value_;
  Model model_{1e-3, 0};  // of one place: nothing but that
  bool smooth_ = false;
  int outliers_ = 0;
};

}  // namespace formwright
