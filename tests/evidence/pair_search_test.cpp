// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/pair_search.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <limits>
#include <numeric>

#include "base/error.h"
#include "evidence/diagnosis.h"
#include "evidence/many_causes.h"
#include "evidence/stepwise_fit.h"

namespace formwright {
namespace {

using evidence_test::ManyCauses;

std::vector<int> all_parameters(const ForwardModel& model) {
  std::vector<int> list(model.parameters().size());
  std::iota(list.begin(), list.end(), 0);
  return list;
}

std::vector<Eigen::VectorXd> even_weights(const ForwardModel& model) {
  const Measurement& m = model.measurements().front();
  return {Eigen::VectorXd::Constant(m.measured.rows(), 1 / (m.sigma[0] * m.sigma[0]))};
}

Linearisation taken_at(const ForwardModel& model, const Eigen::VectorXd& u, std::vector<int> causes) {
  SimulationBag bag(model);
  Context context;
  const Predictions at = *bag.run(u, context, "");
  return {std::move(causes), u, residuals(model, at), sensitivities_at(bag, u, at, all_parameters(model), context, "")};
}

/// ln p(data | two causes) with the whole covariance of the data, no Laplace, no elimination: N(0, C + J P J^T), summed
/// over the sizes of structure, once as the model's own misfit has them and once as unknown structure has them,
/// whichever is likelier.
double evidence_by_brute_force(const ForwardModel& model, const MisfitOfAll& misfit, const Linearisation& nominal,
                               const std::vector<int>& causes) {
  const Eigen::Index n = nominal.residuals.front().rows();
  std::vector<Eigen::MatrixXd> units;
  for (Eigen::Index i = 0; i < n; ++i) units.emplace_back(Eigen::VectorXd::Unit(n, i));
  std::vector<int> free = model.base_parameters();
  for (const int c : causes) free.push_back(model.causes()[static_cast<std::size_t>(c)].parameters.front());
  std::vector<double> values;
  const std::vector<double> sizes = structure_sizes(model);
  for (std::size_t t = 0; t < sizes.size(); ++t) {
    Eigen::MatrixXd covariance =
        misfit.objects().front().gram_at(nominal.residuals.front(), units, t).bottomRightCorner(n, n).inverse();
    for (const int p : free) {
      const Eigen::VectorXd j = nominal.sensitivities.front()[static_cast<std::size_t>(p)];
      covariance += std::pow(model.parameters()[static_cast<std::size_t>(p)].prior_sd, 2) * j * j.transpose();
    }
    const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
    const Eigen::VectorXd r = nominal.residuals.front();
    values.push_back(-0.5 *
                     (r.dot(factor.solve(r)) + 2 * Eigen::MatrixXd(factor.matrixL()).diagonal().array().log().sum()));
  }
  const double largest = *std::max_element(values.begin(), values.end());
  double best = -std::numeric_limits<double>::infinity();
  for (const bool unknown : {false, true}) {
    double sum = 0, prior_sum = 0;
    for (std::size_t t = 0; t < sizes.size(); ++t) {
      const double multiple = sizes[t] / model.known_misfit();
      const double prior = unknown ? (multiple >= 2 ? 1 : 0) : std::exp(-0.5 * multiple * multiple);
      sum += prior * std::exp(values[t] - largest);
      prior_sum += prior;
    }
    best = std::max(best, largest + std::log(sum / prior_sum));
  }
  return best;
}

TEST(PairSearch, OfALinearModelIsBruteForceToTheLastPair) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    ManyCauses model(50, seed);
    Eigen::VectorXd truth = model.nominal();
    truth[0] = 0.4;
    truth[static_cast<Eigen::Index>(2 + seed)] = 0.6;
    truth[static_cast<Eigen::Index>(5 + seed)] = -0.5;
    model.measure(truth, 10 + seed);
    const MisfitOfAll misfit(model, even_weights(model));
    const Linearisation nominal = taken_at(model, model.nominal(), {});
    const std::vector<PairGuess> guesses = guess_pairs(model, misfit, {nominal});
    ASSERT_EQ(guesses.size(), 28u);
    EXPECT_EQ(guesses.front().causes, (std::vector<int>{static_cast<int>(seed), static_cast<int>(3 + seed)})) << seed;
    const double offset =
        guesses.front().log_evidence - evidence_by_brute_force(model, misfit, nominal, guesses.front().causes);
    for (std::size_t i = 0; i < guesses.size(); ++i) {
      EXPECT_NEAR(guesses[i].log_evidence - evidence_by_brute_force(model, misfit, nominal, guesses[i].causes), offset,
                  1e-5);
      if (i > 0) {
        EXPECT_LE(guesses[i].log_evidence, guesses[i - 1].log_evidence);
      }
    }
  }
}

TEST(PairSearch, OfALinearModelDoesNotDependOnWhereItLooksFrom) {
  ManyCauses model(80, 4);
  Eigen::VectorXd truth = model.nominal();
  truth[3] = 0.8;
  truth[7] = 0.4;
  model.measure(truth, 5);
  const MisfitOfAll misfit(model, even_weights(model));
  const std::vector<PairGuess> nominal = guess_pairs(model, misfit, {taken_at(model, model.nominal(), {})});
  Eigen::VectorXd u = model.nominal();
  u[0] = -0.5;
  u[3] = 1.5;
  u[7] = 2;
  // At a pair of which one is taken back: the pairs with the other are left, and each as if nothing had been there.
  const Linearisation back = without_cause(model, taken_at(model, u, {1, 5}), 5);
  EXPECT_EQ(back.causes, std::vector<int>{1});
  EXPECT_EQ(back.u[7], 0);
  const std::vector<PairGuess> moved = guess_pairs(model, misfit, {back});
  ASSERT_EQ(moved.size(), static_cast<std::size_t>(ManyCauses::cause_count - 1));
  for (const PairGuess& m : moved) {
    const auto same =
        std::find_if(nominal.begin(), nominal.end(), [&](const PairGuess& g) { return g.causes == m.causes; });
    ASSERT_NE(same, nominal.end());
    EXPECT_NEAR(m.log_evidence, same->log_evidence, 1e-6);
    EXPECT_LT((m.u - same->u).norm(), 1e-6);
  }
}

TEST(StepwiseFit, GivesUpWhatIsHopelessAndLeavesTheOthersAlone) {
  ManyCauses model(200, 6);
  Eigen::VectorXd truth = model.nominal();
  truth[1] = 0.5;
  truth[4] = 1;
  model.measure(truth, 7);
  const MisfitOfAll misfit(model, even_weights(model));
  const std::vector<Sensitivities> none(1);
  const StructuredObjective objective(model, misfit, 3, {}, none);
  FitOptions options;
  options.tolerance = 0;
  options.least_gain = 0.01;
  const auto fit_of = [&](const std::vector<int>& free) {
    return StepwiseFit(model, objective, free, {model.nominal()}, {}, options);
  };
  Context context;
  SimulationBag bag(model), alone_bag(model);
  std::vector<StepwiseFit> fits{fit_of({0, 1, 4}), fit_of({0, 1, 5})};
  run_side_by_side(bag, fits, std::numeric_limits<double>::infinity(), 20, context, "");
  std::vector<StepwiseFit> alone{fit_of({0, 1, 4})};
  run_side_by_side(alone_bag, alone, std::numeric_limits<double>::infinity(), 20, context, "");
  EXPECT_EQ(fits[0].fit().u, alone[0].fit().u);
  EXPECT_NEAR(fits[0].fit().u[1], 0.5, 0.1);
  EXPECT_NEAR(fits[0].fit().u[4], 1, 0.1);
  EXPECT_GT(fits[1].fit().value, fits[0].fit().value + 20);
  // At rest where the gradient is none: the linear problem's own solution.
  Eigen::VectorXd g;
  Eigen::MatrixXd H;
  objective.quadratic(residuals(model, fits[0].fit().predictions), fits[0].fit().sensitivities, {0, 1, 4},
                      fits[0].fit().u, g, H);
  EXPECT_LT(g.dot(H.llt().solve(g)), 0.02);
}

TEST(StepwiseFit, MayBeginWithoutAnAnswerAtOneOfItsStartsButNotAtAll) {
  ManyCauses model(40, 8);
  const MisfitOfAll misfit(model, even_weights(model));
  const std::vector<Sensitivities> none(1);
  const StructuredObjective objective(model, misfit, 3, {}, none);
  StepwiseFit fit(model, objective, {0}, {model.nominal(), model.nominal()}, {}, {});
  EXPECT_EQ(fit.wanted().size(), 2u);
  EXPECT_THROW(fit.take({std::nullopt, std::nullopt}), Error);
  fit.take({std::nullopt, Predictions{model.predict(0, model.nominal(), Context())}});
  EXPECT_EQ(fit.wanted().size(), 2u);  // both sides of its one parameter
}

/// A strong first cause carries what the others do along with it: about the calibrated model the right pair looks
/// wrong.
TEST(Diagnosis, FindsPairsOfWhichOneChangesTheOther) {
  for (int second = 1; second < ManyCauses::cause_count; second += 2) {
    ManyCauses model(300, 20 + static_cast<unsigned>(second), 1.2);
    Eigen::VectorXd truth = model.nominal();
    truth[0] = 0.3;
    truth[2] = 1.2;
    truth[2 + second] = 0.6;
    model.measure(truth, static_cast<unsigned>(second));
    SimulationBag bag(model);
    Context context;
    std::vector<int> verdict = diagnose(bag, {}, context).verdict;
    std::sort(verdict.begin(), verdict.end());
    EXPECT_EQ(verdict, (std::vector<int>{0, second}));
  }
}

}  // namespace
}  // namespace formwright
