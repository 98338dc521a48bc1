// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Diagnoses a toy and checks what holds for every answer.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>
#include <vector>

#include "evidence/diagnosis/diagnosis.h"
#include "evidence/toy_model.h"

namespace formwright::evidence_test {

/// Verdict, reading and each cause's probability follow from the same answers, which add up to 1.
inline void check_one_answer(const Diagnosis& d) {
  double sum = 0;
  for (const Answer& answer : d.answers) sum += answer.probability;
  CHECK_THAT(sum, Catch::Matchers::WithinAbs(1, 1e-9));
  const Answer& top = d.answers.front();
  std::vector<int> verdict = d.verdict;
  std::sort(verdict.begin(), verdict.end());
  if (d.reading == Reading::none || d.reading == Reading::unknown) {
    CHECK(top.causes.empty());
    CHECK(top.unknown_cause == (d.reading == Reading::unknown));
  } else {
    CHECK(top.causes == verdict);
  }
  for (const CauseFinding& f : d.causes)
    CHECK_THAT(f.probability, Catch::Matchers::WithinAbs(probability_of_cause(d.answers, f.cause), 1e-12));
  for (const FailedCheck& f : d.failed)
    for (const Answer& answer : d.answers) CHECK(answer.causes != f.causes);
}

inline Diagnosis diagnosed(const ForwardModel& model) {
  SimulationBag bag(model);
  Context context;
  Diagnosis d = diagnose(bag, {}, context);
  check_one_answer(d);
  return d;
}

/// Hides a bump of 0.6 and a ripple of 0.4, which are to be named, and returns what is said.
inline Diagnosis diagnosed_pair(ToyModel& model) {
  Eigen::VectorXd truth = model.nominal();
  truth[2] = 0.6;
  truth[3] = 0.4;
  model.measure(truth, 0.05, 12, 0.02);
  Diagnosis d = diagnosed(model);
  std::vector<int> verdict = d.verdict;
  std::sort(verdict.begin(), verdict.end());
  CHECK(verdict == std::vector<int>{0, 1});
  return d;
}

}  // namespace formwright::evidence_test
