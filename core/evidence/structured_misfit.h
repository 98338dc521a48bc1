// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What is left between a model and the data is noise, different at every point, and structure: smooth fields over the object that
// no effect of the model makes. Both are Gaussian here: C = diag(1/w) + tau^2 (I_d x Phi S Phi^T), with Phi cosine modes over the
// object and S falling off like a Matern 3/2 spectrum (Kennedy and O'Hagan 2001: without it, thousands of points would make any
// hundredth of a millimetre of misfit a certain cause of something).
#include <Eigen/Core>
#include <span>
#include <vector>

#include "evidence/forward_model.h"

namespace formwright {

/// Inner products a^T C^-1 b of residuals (first column) and sensitivities (the others), for several sizes tau of the structure.
struct GramByStructure {
  std::vector<Eigen::MatrixXd> gram;     // for each tau, (1 + k) x (1 + k)
  std::vector<double> log_determinant;   // for each tau, of C
  GramByStructure& operator+=(const GramByStructure& other);  // another object, independent of this one
};

class StructuredMisfit {
 public:
  /// `weights`: n, inverse variances of each of the d numbers of a point; 0 leaves the point out. `tau`: sizes, ascending, the first may be 0.
  StructuredMisfit(const Measurement& measurement, Eigen::VectorXd weights, std::vector<double> tau);

  const Eigen::VectorXd& weights() const { return weights_; }
  /// `residual` n x d, `sensitivities` n x d each.
  GramByStructure gram(const Eigen::MatrixXd& residual, std::span<const Eigen::MatrixXd> sensitivities) const;
  /// The same for one size alone: tau[index].
  Eigen::MatrixXd gram_at(const Eigen::MatrixXd& residual, std::span<const Eigen::MatrixXd> sensitivities, std::size_t index) const;
  /// n x d: the smooth part of `residual`, as expected for structure of size tau[index].
  Eigen::MatrixXd smooth(const Eigen::MatrixXd& residual, std::size_t index) const;
  /// n: how far, in variances of the noise's one number, smoothing takes a point with it (leverage in [0, 1)).
  Eigen::VectorXd leverage(std::size_t index) const;

 private:
  template <class Use>
  void for_each_number(const Eigen::MatrixXd& residual, std::span<const Eigen::MatrixXd> sensitivities, Use&& use) const;

  Eigen::VectorXd weights_;
  std::vector<double> tau_;
  Eigen::MatrixXd modes_;       // n x m, scaled by the square roots of S: unit tau gives a field of RMS about 1
  std::vector<Eigen::MatrixXd> factor_;  // for each tau > 0: lower Cholesky factor of I / tau^2 + Phi^T W Phi
};

}  // namespace formwright
