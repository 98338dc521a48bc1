// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What may be wrong, and how well each explanation predicts the data: marginal likelihoods of a linearised model
// (Laplace), in which base parameters, effects and the discrepancy parameters have Gaussian priors and structure
// of unknown origin has its say.
#include <Eigen/Core>
#include <string>
#include <vector>

#include "evidence/fit/forward_model.h"
#include "evidence/fit/structured_misfit.h"

namespace formwright {

/// An explanation: none, one or two causes, with or without structure that no cause of the list makes.
struct Hypothesis {
  std::vector<int> causes;  // indices into ForwardModel::causes(), ascending
  bool unknown_structure = false;
  double log_prior = 0;
  double log_evidence = 0;  // up to a constant of the data
  double structure = 0;     // expected size of what is left unexplained, unit of the measurement
  Eigen::VectorXd u;        // all parameters: where it is most probable
  double probability = 0;
};

/// Sizes of structure that are considered, as multiples of ForwardModel::known_misfit(); the first is 0.
std::vector<double> structure_sizes(const ForwardModel& model);

/// Sums over structure sizes. `columns`: which parameters the sensitivities in `gram` belong to, in order; `u0`: where
/// they and the residual were taken. Effects that are in `columns` but not of the causes have
/// ModelParameter::usual_sd, and stay at u0 where that is 0.
void weigh(const ForwardModel& model, const GramByStructure& gram, const std::vector<int>& columns,
           const Eigen::VectorXd& u0, Hypothesis& hypothesis);

/// None, unknown, each cause, each pair, with their priors.
std::vector<Hypothesis> all_hypotheses(const ForwardModel& model, bool pairs);

/// Probabilities from evidence and priors, sorted by it.
void normalise(std::vector<Hypothesis>& hypotheses);

/// Cosine between what two causes do that nothing else can do, each at its most alike direction; 1 when the data cannot
/// tell them apart.
double similarity(const ForwardModel& model, const GramByStructure& gram, std::size_t structure,
                  const std::vector<int>& columns, int cause_a, int cause_b);

/// How strong a cause must be, in its worst direction, for these data to show it beside all that base parameters and
/// discrepancies can imitate; infinite where they imitate it wholly. In the cause's coordinates. `gram`: with the
/// sensitivities to `columns` at two places, one set after the other. What contact and the mesh do to them is different
/// at each: only what both have in common counts. Where a base parameter was measured (ModelParameter::was_measured),
/// the second place alone counts, which is that of the measured values.
double min_visible_strength(const ForwardModel& model, const GramByStructure& gram, std::size_t structure,
                            const std::vector<int>& columns, int cause);

}  // namespace formwright
