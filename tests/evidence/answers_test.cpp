// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/diagnosis/answers.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>
#include <algorithm>
#include <cmath>
#include <random>

namespace formwright {
namespace {

using Catch::Matchers::WithinAbs;

Hypothesis explanation(std::vector<int> causes, bool unknown, double log_weight) {
  Hypothesis h;
  h.causes = std::move(causes);
  h.unknown_structure = unknown;
  h.log_evidence = log_weight;
  return h;
}

std::vector<Hypothesis> weighed(std::vector<Hypothesis> hypotheses) {
  normalise(hypotheses);
  return hypotheses;
}

double probability_of(const std::vector<Answer>& answers, const std::vector<int>& causes, bool unknown) {
  for (const Answer& answer : answers)
    if (answer.causes == causes && answer.unknown_cause == unknown) return answer.probability;
  return 0;
}

double sum_of(const std::vector<Answer>& answers) {
  double sum = 0;
  for (const Answer& answer : answers) sum += answer.probability;
  return sum;
}

TEST_CASE("Answers.WithoutAFailedCheckAreTheExplanations") {
  const auto answers =
      answers_of(weighed({explanation({}, false, std::log(0.2)), explanation({}, true, std::log(0.1)),
                          explanation({0}, false, std::log(0.4)), explanation({0, 1}, false, std::log(0.3))}),
                 {});
  CHECK_THAT(probability_of(answers, {}, false), WithinAbs(0.2, 1e-12));
  CHECK_THAT(probability_of(answers, {}, true), WithinAbs(0.1, 1e-12));
  CHECK_THAT(probability_of(answers, {0}, false), WithinAbs(0.4, 1e-12));
  CHECK(answers.front().causes == std::vector<int>{0});
  CHECK_THAT(probability_of_cause(answers, 0), WithinAbs(0.7, 1e-12));
  CHECK_THAT(probability_of_cause(answers, 1), WithinAbs(0.3, 1e-12));
}

TEST_CASE("Answers.WhatFailedGoesToWhatIsLeftInItsOwnRatio") {
  // Without causes the data are e^-900 as probable: no double holds that share, and its ratio of 3 to 1 still counts.
  const auto hypotheses = weighed({explanation({}, false, std::log(3.0) - 900), explanation({}, true, -900),
                                   explanation({2}, false, std::log(4.0)), explanation({5}, false, 0)});
  const auto answers = answers_of(hypotheses, {{{2}, {}, Failure::near_zero, 0}});
  CHECK_THAT(probability_of(answers, {}, false), WithinAbs(0.6, 1e-12));
  CHECK_THAT(probability_of(answers, {}, true), WithinAbs(0.2, 1e-12));
  CHECK_THAT(probability_of(answers, {5}, false), WithinAbs(0.2, 1e-12));
  CHECK(probability_of_cause(answers, 2) == 0);
}

TEST_CASE("Answers.APartnerThatFailedLeavesTheOther") {
  const auto hypotheses = weighed({explanation({}, false, std::log(0.1)), explanation({}, true, std::log(0.1)),
                                   explanation({3}, false, std::log(0.15)), explanation({3}, true, std::log(0.05)),
                                   explanation({3, 7}, false, std::log(0.6))});
  const std::vector<FailedCheck> partner{{{3, 7}, {3}, Failure::near_zero, 0}};
  const auto answers = answers_of(hypotheses, partner);
  CHECK_THAT(probability_of(answers, {3}, false), WithinAbs(0.15 + 0.75 * 0.6, 1e-12));
  CHECK_THAT(probability_of(answers, {3}, true), WithinAbs(0.05 + 0.25 * 0.6, 1e-12));
  // The other fails, too: nothing is left of either.
  std::vector<FailedCheck> both = partner;
  both.push_back({{3}, {}, Failure::predicts_no_better, 0});
  const auto none = answers_of(hypotheses, both);
  CHECK_THAT(probability_of(none, {}, false), WithinAbs(0.5, 1e-12));
  CHECK_THAT(probability_of(none, {}, true), WithinAbs(0.5, 1e-12));
}

TEST_CASE("Answers.WhatExplainsTooLittleIsACauseThatIsNotInTheList") {
  const auto hypotheses = weighed({explanation({}, false, std::log(0.1)), explanation({}, true, std::log(0.1)),
                                   explanation({1}, false, std::log(0.5)), explanation({1}, true, std::log(0.3))});
  const auto answers = answers_of(hypotheses, {{{1}, {}, Failure::explains_too_little, 0}});
  CHECK(answers.front().causes.empty());
  CHECK(answers.front().unknown_cause);
  CHECK_THAT(answers.front().probability, WithinAbs(0.9, 1e-12));
}

TEST_CASE("Answers.WhatNeedsAnotherMaterialIsACauseThatIsNotInTheList") {
  const auto hypotheses = weighed({explanation({}, false, std::log(0.6)), explanation({}, true, std::log(0.1)),
                                   explanation({1}, false, std::log(0.3))});
  const auto answers = answers_of(hypotheses, {{{}, {}, Failure::other_material, 0}});
  CHECK(answers.front().unknown_cause);
  CHECK_THAT(probability_of(answers, {}, true), WithinAbs(0.7, 1e-12));
  CHECK_THAT(probability_of(answers, {1}, false), WithinAbs(0.3, 1e-12));
  // A cause that failed, too, leaves nothing else.
  const auto both = answers_of(hypotheses, {{{1}, {}, Failure::near_zero, 0}, {{}, {}, Failure::other_material, 0}});
  CHECK_THAT(probability_of(both, {}, true), WithinAbs(1, 1e-12));
}

TEST_CASE("Answers.AddUpToOneWhateverFails") {
  std::mt19937 random(8);
  for (int round = 0; round < 200; ++round) {
    std::vector<Hypothesis> hypotheses;
    std::uniform_real_distribution<double> weight(-400, 400), share(0, 1);
    std::vector<std::vector<int>> sets{{}, {0}, {1}, {2}, {0, 1}, {0, 2}, {1, 2}};
    std::vector<FailedCheck> failed;
    for (const auto& causes : sets) {
      hypotheses.push_back(explanation(causes, false, weight(random)));
      if (causes.size() < 2 || share(random) < 0.5) hypotheses.push_back(explanation(causes, true, weight(random)));
      if (causes.empty() || share(random) < 0.5) continue;
      const bool keeps = causes.size() == 2 && share(random) < 0.5;
      failed.push_back({causes, keeps ? std::vector<int>{causes.front()} : std::vector<int>{},
                        share(random) < 0.2 ? Failure::explains_too_little : Failure::near_zero, 0});
    }
    const auto answers = answers_of(weighed(hypotheses), failed);
    CHECK_THAT(sum_of(answers), WithinAbs(1, 1e-12));
    CHECK(std::is_sorted(answers.begin(), answers.end(),
                         [](const Answer& a, const Answer& b) { return a.probability > b.probability; }));
    for (const FailedCheck& f : failed) {
      INFO("round " << round);
      CHECK(probability_of(answers, f.causes, false) + probability_of(answers, f.causes, true) == 0);
    }
  }
}

}  // namespace
}  // namespace formwright
