// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What measuring a point tells about the causes, before it is measured: Bayesian design of experiments for a linear
// model [CV95].
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

#include "evidence/fit/parameter_fit.h"
#include "evidence/fit/structured_misfit.h"

namespace formwright {

/// A point is y = J theta + tau Phi z + e. J are sensitivities, theta all parameters with their priors, z the
/// coefficients of structure that no cause makes (structured_misfit.h), e noise. What is counted is the mutual
/// information of the measured points and the causes' parameters, with all others integrated out: (log det of their
/// prior covariance - log det of their posterior covariance) / 2, in nats.
class PointInformation {
 public:
  /// Of the first measurement of `model`, and of the other quantities of its object. `sensitivities`: of all
  /// parameters, n x d each, of each measurement. `precisions`: of the points, n x d^2; a row of zeros is a point that
  /// cannot be measured. `structure`: tau, in the unit of the measurement. Rows are counted through all measurements.
  PointInformation(const ForwardModel& model, const std::vector<Sensitivities>& sensitivities,
                   const std::vector<Precisions>& precisions, double structure);

  /// What measuring this point would add, nats; 0 for one that cannot be measured.
  double gain(Eigen::Index row) const;
  /// From now on the point is measured. Ignored for one that cannot be.
  void measure(Eigen::Index row);
  /// Of everything measured so far, nats.
  double total() const { return total_; }

 private:
  struct Seen {
    Eigen::MatrixXd causes, spread;  // k x d and d x d: covariances of the causes with the point, and of the point
  };
  struct Point {
    Eigen::Index column = 0, d = 0;  // of effects_
    Eigen::MatrixXd noise;           // d x d; empty where the point cannot be measured
  };
  const Point& point(Eigen::Index row) const { return points_[static_cast<std::size_t>(row)]; }
  void add(const Measurement& measurement, const Sensitivities& sensitivities, const Precisions& precisions,
           double structure, Eigen::Index first_of_structure);
  Seen seen(Eigen::Index row) const;

  std::vector<Point> points_;
  std::vector<Eigen::Index> causes_;  // rows of the unknowns
  Eigen::MatrixXd effects_;           // unknowns x (sum of n d): transposed rows of [J, tau Phi]
  Eigen::MatrixXd covariances_;       // as many: of the unknowns with the points, given what was measured
  Eigen::MatrixXd cause_covariance_;  // k x k, given what was measured
  Eigen::LLT<Eigen::MatrixXd> cause_factor_;
  double total_ = 0;
};

/// The same of a whole set of points at once. `gram`: inner products of the sensitivities to all parameters
/// (StructuredMisfit::gram without the residual's row and column).
double information_about_causes(const ForwardModel& model, const Eigen::MatrixXd& gram);

}  // namespace formwright
