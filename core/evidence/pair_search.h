// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Which two causes may be at work together: all pairs weighed by linear models taken at several places, without a
// simulation.
#include "evidence/hypotheses.h"
#include "evidence/structured_objective.h"

namespace formwright {

/// The model about u: what it predicts there, and what every parameter does.
struct Linearisation {
  std::vector<int> causes;  // that are at work at u
  Eigen::VectorXd u;
  Predictions residuals;                     // at u
  std::vector<Sensitivities> sensitivities;  // each object, of all parameters in order
};

/// As `about` would be without `cause`, as far as a straight line goes: so that another may take its place.
Linearisation without_cause(const ForwardModel& model, Linearisation about, int cause);

/// Weight of an explanation that nobody has fitted yet.
struct PairGuess {
  std::vector<int> causes;  // two, ascending
  double log_evidence = 0;
  Eigen::VectorXd u;     // where it is most probable
  std::size_t from = 0;  // the linearisation that likes it best
};

/// Every pair, the likeliest first. Each counts as the linearisation has it that likes it best, of those whose causes
/// it contains: what else is at work there would have to go a long way back to zero.
std::vector<PairGuess> guess_pairs(const ForwardModel& model, const MisfitOfAll& misfit,
                                   const std::vector<Linearisation>& about);

}  // namespace formwright
