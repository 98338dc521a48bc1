// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What may be wrong, with one set of probabilities that adds up to 1: how well the explanations fit, once those that
// fail a check have given up the causes that failed.
#include "evidence/fit/hypotheses.h"

namespace formwright {

/// Why a cause that fits is not believed.
enum class Failure {
  too_small,            // it moves points by less than half of the simulation's own error
  predicts_no_better,   // of points that were left out of the fit
  near_zero,            // its strength, with so many causes tried
  like_the_material,    // another material does the same to these data
  explains_too_little,  // of the misfit
  nothing_to_explain,   // hardly anything is left without it, and it explains little of that
  other_material,       // it needs one that is not what was measured before: of the explanation without causes
  behind_failed,        // less likely than several that failed
};

/// One sentence for a maker.
const char* failure_sentence(Failure failure);
/// As in diagnosis.json: "too_small", ...
const char* failure_name(Failure failure);

/// An explanation that failed a check. `kept`: those of its causes that did not fail, ascending.
struct FailedCheck {
  std::vector<int> causes, kept;
  Failure failure = Failure::near_zero;
  double fit_probability = 0;  // by how well it fits alone
};

/// One possible answer: these causes and no others, with or without something else that no cause of the list makes.
struct Answer {
  std::vector<int> causes;  // ascending; none and no unknown cause: nothing is wrong
  bool unknown_cause = false;
  double probability = 0;
};

/// The answers that `hypotheses` give, most probable first; they add up to 1. The probability of an explanation that
/// failed goes to the explanations without the causes that failed, in the ratio of their own probabilities: what
/// a failed cause seems to explain is then as likely theirs to explain as anything else is. What explains too little,
/// or needs another material, goes to the unknown cause. Takes the two explanations without causes to be among
/// `hypotheses`.
std::vector<Answer> answers_of(const std::vector<Hypothesis>& hypotheses, const std::vector<FailedCheck>& failed);

/// Probability that a cause is at work, alone or beside others.
double probability_of_cause(const std::vector<Answer>& answers, int cause);

}  // namespace formwright
