// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a diagnosis makes small: misfit against noise and structure (structured_misfit.h), with the priors, and with the
// nuisance parameters integrated out.
#include <Eigen/Cholesky>

#include "evidence/fit/noise_model.h"
#include "evidence/fit/parameter_fit.h"
#include "evidence/fit/structured_misfit.h"

namespace formwright {

/// The misfits of all objects at one set of precisions.
class MisfitOfAll {
 public:
  MisfitOfAll(const ForwardModel& model, const std::vector<Precisions>& precisions);
  /// Sum over objects of the Gram matrices of residuals and sensitivities.
  GramByStructure gram(const Predictions& residuals, const std::vector<Sensitivities>& sensitivities) const;
  const std::vector<double>& sizes() const { return sizes_; }
  const std::vector<StructuredMisfit>& objects() const { return objects_; }

 private:
  std::vector<double> sizes_;
  std::vector<StructuredMisfit> objects_;
};

/// What equally good simulations would move, a standard deviation each, for every object. `discrepancies`: discrepancy
/// parameters; their sensitivities, each object.
std::vector<std::vector<Eigen::MatrixXd>> movements_of(const ForwardModel& model, const std::vector<int>& discrepancies,
                                                       const std::vector<Sensitivities>& sensitivities);

/// Where the simulation is not to be relied on, points weigh less (model_covariance). `weights`: inverse variances of
/// the noise; `movements`: each object.
std::vector<Precisions> precisions_of(const ForwardModel& model, const std::vector<Eigen::VectorXd>& weights,
                                      const std::vector<std::vector<Eigen::MatrixXd>>& movements);

/// What data may differ by though nothing that is fitted is at work: the discrepancy parameters, and effects as small
/// as they usually are. They are integrated out, with ModelParameter::sd_without_cause().
struct NuisanceParameters {
  std::vector<int> parameters;
  std::vector<Sensitivities> sensitivities;  // each object
};

/// `structure`: index into MisfitOfAll::sizes(). Model and misfit must outlive it.
class StructuredObjective : public FitObjective {
 public:
  StructuredObjective(const ForwardModel& model, const MisfitOfAll& misfit, std::size_t structure,
                      const NuisanceParameters& nuisances);
  double value(const Predictions& residuals, const Eigen::VectorXd& u) const override;
  void quadratic(const Predictions& residuals, const std::vector<Sensitivities>& sensitivities,
                 const std::vector<int>& free, const Eigen::VectorXd& u, Eigen::VectorXd& g,
                 Eigen::MatrixXd& H) const override;

 private:
  /// The Gram matrix without what the nuisance parameters explain.
  Eigen::MatrixXd reduced(const Predictions& residuals, const std::vector<Sensitivities>& sensitivities) const;

  const ForwardModel& model_;
  const MisfitOfAll& misfit_;
  std::size_t structure_;
  std::vector<Sensitivities> weighed_nuisances_;  // each object: C^-1 N of their sensitivities N
  Eigen::LLT<Eigen::MatrixXd> nuisance_factor_;   // of N^T C^-1 N and their priors
};

}  // namespace formwright
