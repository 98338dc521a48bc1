// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What is left between a model and the data is noise, different at every point and in every direction, and structure:
// smooth fields over the object that no effect of the model makes. Both are Gaussian here: C = W^-1 + tau^2 (I_d x Phi
// S Phi^T), with W a d x d block a point, Phi cosine modes over the object and S falling off like a Matern 3/2 spectrum
// (Kennedy and O'Hagan 2001: without it, thousands of points would make any hundredth of a millimetre of misfit a
// certain cause of something).
#include <Eigen/Core>
#include <span>
#include <vector>

#include "evidence/fit/forward_model.h"

namespace formwright {

/// Inner products a^T C^-1 b of residuals (first column) and sensitivities (the others), for several sizes tau of the
/// structure.
struct GramByStructure {
  std::vector<Eigen::MatrixXd> gram;                          // for each tau, (1 + k) x (1 + k)
  std::vector<double> log_determinant;                        // for each tau, of C
  GramByStructure& operator+=(const GramByStructure& other);  // another object, independent of this one
};

/// How well each point is known: n rows of d x d inverse covariances, symmetric; a row of zeros leaves the point out.
using Precisions = Eigen::MatrixXd;

/// The same inverse variance in every direction. `weights`: n.
Precisions isotropic(const Eigen::VectorXd& weights, Eigen::Index d);
/// n: inverses of the mean variances over directions, 0 for points that are left out.
Eigen::VectorXd mean_weights(const Precisions& precisions);

inline constexpr Eigen::Index structure_mode_count = 81;

/// n x structure_mode_count: the fields Phi S^(1/2) at `place` (n x 2). With independent coefficients of size 1 they
/// make a field of RMS about 1.
Eigen::MatrixXd structure_modes(const Eigen::MatrixX2d& place);

class StructuredMisfit {
 public:
  /// `tau`: sizes, ascending, the first may be 0.
  StructuredMisfit(const Measurement& measurement, Precisions precisions, std::vector<double> tau);

  /// `residual` n x d, `sensitivities` n x d each.
  GramByStructure gram(const Eigen::MatrixXd& residual, std::span<const Eigen::MatrixXd> sensitivities) const;
  /// The same for one size alone: tau[index].
  Eigen::MatrixXd gram_at(const Eigen::MatrixXd& residual, std::span<const Eigen::MatrixXd> sensitivities,
                          std::size_t index) const;
  /// n x d each: C^-1 times `columns`, for tau[index].
  std::vector<Eigen::MatrixXd> weighed(std::span<const Eigen::MatrixXd> columns, std::size_t index) const;
  /// n x d: the smooth part of `residual`, as expected for structure of size tau[index].
  Eigen::MatrixXd smooth(const Eigen::MatrixXd& residual, std::size_t index) const;
  /// n: how far smoothing takes a point with it, mean over directions (leverage in [0, 1)).
  Eigen::VectorXd leverage(std::size_t index) const;

 private:
  struct Products {
    Eigen::MatrixXd plain;      // columns^T W columns, (1 + k) x (1 + k)
    Eigen::MatrixXd projected;  // (I_d x Phi)^T W columns, d m x (1 + k)
  };
  Products products(const Eigen::MatrixXd& residual, std::span<const Eigen::MatrixXd> sensitivities) const;
  auto weight(Eigen::Index row, Eigen::Index col) const { return precisions_.col(row * d_ + col).asDiagonal(); }

  Precisions precisions_;
  Eigen::Index d_;
  std::vector<double> tau_;
  Eigen::MatrixXd modes_;  // n x m, scaled by the square roots of S: unit tau gives a field of RMS about 1
  double log_noise_ = 0;   // log determinant of W^-1
  std::vector<Eigen::MatrixXd>
      factor_;  // for each tau > 0: lower Cholesky factor of I / tau^2 + (I_d x Phi)^T W (I_d x Phi)
};

}  // namespace formwright
