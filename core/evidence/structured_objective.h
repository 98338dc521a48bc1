// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a diagnosis makes small: misfit against noise and structure (structured_misfit.h), with the priors, and with the simulation's
// known liberties integrated out.
#include "evidence/noise_model.h"
#include "evidence/parameter_fit.h"
#include "evidence/structured_misfit.h"

namespace formwright {

/// The misfits of all objects at one set of weights.
class MisfitOfAll {
 public:
  MisfitOfAll(const ForwardModel& model, const std::vector<Eigen::VectorXd>& weights);
  /// Sum over objects of the Gram matrices of residuals and sensitivities.
  GramByStructure gram(const Predictions& residuals, const std::vector<Sensitivities>& sensitivities) const;
  const std::vector<double>& sizes() const { return sizes_; }
  const std::vector<StructuredMisfit>& objects() const { return objects_; }

 private:
  std::vector<double> sizes_;
  std::vector<StructuredMisfit> objects_;
};

/// Where equally good simulations disagree, points weigh less (model_variance). `liberties`: discrepancy parameters; their sensitivities, each object.
std::vector<Eigen::VectorXd> weights_with_liberties(const ForwardModel& model, std::vector<Eigen::VectorXd> weights, const std::vector<int>& liberties,
                                                    const std::vector<Sensitivities>& sensitivities);

/// `liberties`: sensitivities to the discrepancy parameters, `structure`: index into MisfitOfAll::sizes(). Everything must outlive it.
class StructuredObjective : public FitObjective {
 public:
  StructuredObjective(const ForwardModel& model, const MisfitOfAll& misfit, std::size_t structure, std::vector<int> liberty_parameters,
                      const std::vector<Sensitivities>& liberties)
      : model_(model), misfit_(misfit), structure_(structure), liberty_parameters_(std::move(liberty_parameters)), liberties_(liberties) {}
  double value(const Predictions& residuals, const Eigen::VectorXd& u) const override;
  void quadratic(const Predictions& residuals, const std::vector<Sensitivities>& sensitivities, const std::vector<int>& free, const Eigen::VectorXd& u,
                 Eigen::VectorXd& g, Eigen::MatrixXd& H) const override;

 private:
  /// The Gram matrix without what the liberties explain.
  Eigen::MatrixXd reduced(const Predictions& residuals, const std::vector<Sensitivities>& sensitivities) const;

  const ForwardModel& model_;
  const MisfitOfAll& misfit_;
  std::size_t structure_;
  std::vector<int> liberty_parameters_;
  const std::vector<Sensitivities>& liberties_;
};

}  // namespace formwright
