// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/diagnosis/answers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace formwright {
namespace {

using Key = std::pair<std::vector<int>, bool>;

const FailedCheck* failed_check_of(const std::vector<FailedCheck>& failed, const std::vector<int>& causes) {
  const auto at = std::find_if(failed.begin(), failed.end(), [&](const FailedCheck& f) { return f.causes == causes; });
  return at == failed.end() ? nullptr : &*at;
}

/// Share of an explanation's probability that is its form with an unknown cause; of one that is not listed, none.
double unknown_share(const std::vector<Hypothesis>& hypotheses, const std::vector<int>& causes) {
  constexpr double impossible = -std::numeric_limits<double>::infinity();
  double plain = impossible, unknown = impossible;
  for (const Hypothesis& h : hypotheses)
    if (h.causes == causes) (h.unknown_structure ? unknown : plain) = h.log_prior + h.log_evidence;
  if (unknown == impossible) return 0;
  return 1 / (1 + std::exp(plain - unknown));  // of logarithms: either probability may be too small for a double
}

}  // namespace

const char* failure_name(Failure failure) {
  switch (failure) {
    case Failure::too_small: return "too_small";
    case Failure::predicts_no_better: return "predicts_no_better";
    case Failure::near_zero: return "near_zero";
    case Failure::like_the_material: return "like_the_material";
    case Failure::explains_too_little: return "explains_too_little";
    case Failure::nothing_to_explain: return "nothing_to_explain";
    case Failure::other_material: return "other_material";
    case Failure::behind_failed: return "behind_failed";
  }
  return "";
}

const char* failure_sentence(Failure failure) {
  switch (failure) {
    case Failure::too_small: return "It would fit, but moves points by less than half of the simulation's own error.";
    case Failure::predicts_no_better: return "It would fit, but does not predict the points that were left out better.";
    case Failure::near_zero:
      return "It would fit, but with so many causes tried, chance gives a strength like this, too.";
    case Failure::like_the_material: return "It would fit, but another material would do the same to these data.";
    case Failure::explains_too_little: return "It is the most similar cause, but explains too little of the error.";
    case Failure::nothing_to_explain: return "It would fit, but without it hardly anything is left to explain.";
    case Failure::other_material:
      return "It would fit, but only with a material that is far from what was measured before.";
    case Failure::behind_failed: return "It fits worse than causes that failed a check.";
  }
  return "";
}

std::vector<Answer> answers_of(const std::vector<Hypothesis>& hypotheses, const std::vector<FailedCheck>& failed) {
  std::map<Key, double> sums;
  for (const Hypothesis& h : hypotheses) {
    std::vector<int> causes = h.causes;
    const FailedCheck* check = failed_check_of(failed, causes);
    if (check == nullptr) {
      sums[{causes, h.unknown_structure}] += h.probability;
      continue;
    }
    bool not_listed = false;
    while (check != nullptr) {  // what is kept may have failed by itself
      not_listed |= check->failure == Failure::explains_too_little || check->failure == Failure::other_material;
      const bool at_nothing = causes.empty();
      causes = check->kept;
      check = at_nothing ? nullptr : failed_check_of(failed, causes);
    }
    const double unknown = not_listed ? 1 : unknown_share(hypotheses, causes);
    sums[{causes, true}] += unknown * h.probability;
    sums[{causes, false}] += (1 - unknown) * h.probability;
  }
  std::vector<Answer> answers;
  double total = 0;
  for (const auto& [key, sum] : sums) total += sum;
  for (const auto& [key, sum] : sums) answers.push_back({key.first, key.second, sum / total});
  std::stable_sort(answers.begin(), answers.end(),
                   [](const Answer& a, const Answer& b) { return a.probability > b.probability; });
  return answers;
}

double probability_of_cause(const std::vector<Answer>& answers, int cause) {
  double sum = 0;
  for (const Answer& answer : answers)
    if (std::find(answer.causes.begin(), answer.causes.end(), cause) != answer.causes.end()) sum += answer.probability;
  return sum;
}

}  // namespace formwright
