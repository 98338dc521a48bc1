// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/fit/structured_misfit.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Dense>

#include "evidence/fit/hypotheses.h"
#include "evidence/fit/noise_model.h"
#include "evidence/fit/structured_objective.h"
#include "evidence/toy_model.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinULP;

using evidence_test::ToyModel;

/// C^-1 as a dense matrix: inner products of unit vectors.
Eigen::MatrixXd inverse_covariance(const StructuredMisfit& misfit, Eigen::Index n, std::size_t index) {
  Eigen::MatrixXd inverse(n, n);
  std::vector<Eigen::MatrixXd> units;
  for (Eigen::Index i = 0; i < n; ++i) units.push_back(Eigen::MatrixXd(Eigen::VectorXd::Unit(n, i)));
  return misfit.gram_at(Eigen::MatrixXd::Zero(n, 1), units, index).bottomRightCorner(n, n);
}

TEST_CASE("StructuredMisfit.GramMatrixIsThatOfADenseCovariance") {
  ToyModel model(40);
  const Eigen::VectorXd weights = Eigen::VectorXd::LinSpaced(40, 50, 400);
  const std::vector<double> sizes{0, 0.1, 1};
  const StructuredMisfit one(model.measurements().front(), isotropic(weights, 1), sizes),
      misfit(model.measurements().front(), isotropic(weights, 2), sizes);
  const Eigen::MatrixXd residual = Eigen::MatrixXd::Random(40, 2);
  const std::vector<Eigen::MatrixXd> columns{Eigen::MatrixXd::Random(40, 2), Eigen::MatrixXd::Random(40, 2)};
  const GramByStructure gram = misfit.gram(residual, columns);
  for (std::size_t t = 0; t < sizes.size(); ++t) {
    const Eigen::MatrixXd inverse = inverse_covariance(one, 40, t);
    // The structure has the size it is said to have: the mean of C's diagonal is noise and tau^2.
    const Eigen::MatrixXd C = inverse.inverse();
    CHECK_THAT(C.diagonal().mean(),
               WithinAbs(weights.cwiseInverse().mean() + sizes[t] * sizes[t], 0.35 * sizes[t] * sizes[t] + 1e-12));
    CHECK_THAT(gram.gram[t](0, 0),
               WithinAbs((residual.transpose() * inverse * residual).trace(), 1e-6 * gram.gram[t](0, 0)));
    CHECK_THAT(gram.gram[t](1, 2),
               WithinAbs((columns[0].transpose() * inverse * columns[1]).trace(), 1e-6 * gram.gram[t](1, 1)));
    CHECK_THAT(gram.log_determinant[t],
               WithinAbs(-2 * std::log(inverse.determinant()), 1e-6 * std::abs(gram.log_determinant[t]) + 1e-6));
  }
}

TEST_CASE("StructuredMisfit.DirectionsOfAPointMayBeKnownDifferently") {
  // Against a dense covariance of all numbers: W^-1 and tau^2 times the same structure for either direction.
  constexpr Eigen::Index n = 30;
  ToyModel model(n);
  const Measurement& m = model.measurements().front();
  const Eigen::VectorXd weights = Eigen::VectorXd::LinSpaced(n, 50, 400);
  const std::vector<Eigen::MatrixXd> movements{0.3 * Eigen::MatrixXd::Random(n, 2),
                                               0.1 * Eigen::MatrixXd::Random(n, 2)};
  const double tau = 0.2;
  const StructuredMisfit misfit(m, precisions_of(model, {weights}, {movements}).front(), {0, tau});
  const StructuredMisfit plain(m, isotropic(Eigen::VectorXd::Ones(n), 1), {tau});
  const Eigen::MatrixXd structure = inverse_covariance(plain, n, 0).inverse() - Eigen::MatrixXd::Identity(n, n);
  const Eigen::MatrixXd variance = model_covariance(m, movements);
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  C.topLeftCorner(n, n) = C.bottomRightCorner(n, n) = structure;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (int p = 0; p < 2; ++p)
      for (int q = 0; q < 2; ++q) C(p * n + i, q * n + i) += variance(i, 2 * p + q) + (p == q) / weights[i];
  }
  const Eigen::MatrixXd residual = Eigen::MatrixXd::Random(n, 2), column = Eigen::MatrixXd::Random(n, 2);
  const auto stacked = [](const Eigen::MatrixXd& a) { return Eigen::VectorXd(a.reshaped()); };
  const Eigen::VectorXd solved = C.ldlt().solve(stacked(residual));
  const GramByStructure gram = misfit.gram(residual, std::vector<Eigen::MatrixXd>{column});
  CHECK_THAT(gram.gram[1](0, 0), WithinAbs(stacked(residual).dot(solved), 1e-8 * gram.gram[1](0, 0)));
  CHECK_THAT(gram.gram[1](1, 0), WithinAbs(stacked(column).dot(solved), 1e-8 * gram.gram[1](0, 0)));
  CHECK_THAT(gram.log_determinant[1],
             WithinAbs(std::log(C.determinant()), 1e-6 * std::abs(gram.log_determinant[1]) + 1e-6));
  // The smooth part is what structure would be expected to be, and the leverage how a point's own number moves it.
  const Eigen::MatrixXd smooth = misfit.smooth(residual, 1);
  Eigen::MatrixXd both = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  both.topLeftCorner(n, n) = both.bottomRightCorner(n, n) = structure;
  CHECK((stacked(smooth) - both * solved).cwiseAbs().maxCoeff() < 1e-8);
  const Eigen::MatrixXd hat = both * C.inverse();
  const Eigen::VectorXd leverage = misfit.leverage(1);
  for (Eigen::Index i = 0; i < n; ++i) CHECK_THAT(leverage[i], WithinAbs(0.5 * (hat(i, i) + hat(n + i, n + i)), 1e-8));
}

TEST_CASE("StructuredMisfit.PointsOfWeightZeroDoNotCount") {
  ToyModel model(60);
  Eigen::VectorXd weights = Eigen::VectorXd::Constant(60, 100);
  weights.tail(20).setZero();
  Eigen::MatrixXd residual = Eigen::MatrixXd::Random(60, 2);
  const StructuredMisfit misfit(model.measurements().front(), isotropic(weights, 2), {0.2});
  const double before = misfit.gram_at(residual, {}, 0)(0, 0);
  residual.bottomRows(20).setConstant(1e6);
  CHECK_THAT(misfit.gram_at(residual, {}, 0)(0, 0), WithinULP(before, 4));
}

TEST_CASE("NoiseModel.FindsNoiseUnderAFieldAndOutliers") {
  ToyModel model(1500);
  Eigen::VectorXd u = model.nominal();
  u[2] = 0.8;
  model.measure(u, 0.07, 5, 0.03);
  model.measurement().sigma.setConstant(0.035);  // said to be twice as good as they are
  const Eigen::MatrixXd residual = model.measurements().front().measured - model.predict(0, model.nominal(), Context());
  const NoiseEstimate noise = estimate_noise(model.measurements().front(), residual);
  CHECK_THAT(noise.sigma, WithinAbs(0.07, 0.006));
  CHECK_THAT(noise.scale, WithinAbs(2, 0.2));
  CHECK_THAT(noise.outliers, WithinAbs(45, 15));
}

TEST_CASE("NoiseModel.StructureIsDistinguishedFromNoise") {
  ToyModel model(800);
  model.measure(model.nominal(), 0.05, 3);
  const Eigen::MatrixXd noise = model.measurements().front().measured - model.predict(0, model.nominal(), Context());
  const Eigen::VectorXd weights = Eigen::VectorXd::Constant(800, 400);
  CHECK(test_structure(model.measurements().front(), noise, weights).p_value > 0.02);
  Eigen::VectorXd u = model.nominal();
  u[2] = 0.3;
  const Eigen::MatrixXd field = model.measurements().front().measured - model.predict(0, u, Context());
  const StructureTest found = test_structure(model.measurements().front(), field, weights);
  CHECK(found.p_value < 0.01);
  CHECK(found.neighbour_correlation > 0.3);
  CHECK(found.correlation_length_mm > 5);
  CHECK(found.correlation_length_mm < 40);
}

TEST_CASE("Hypotheses.EvidenceIsThatOfTheMarginalGaussian") {
  // One base parameter and one effect in a linear model: log p(y) = log N(y; 0, C + J S J^T), up to what the data alone
  // decide.
  ToyModel model(30);
  Eigen::VectorXd u = model.nominal();
  u[1] = 0.3;
  u[2] = 0.5;
  model.measure(u, 0.05, 2);
  const Eigen::VectorXd weights = Eigen::VectorXd::Constant(30, 400);
  const StructuredMisfit misfit(model.measurements().front(), isotropic(weights, 2), structure_sizes(model)),
      one(model.measurements().front(), isotropic(weights, 1), structure_sizes(model));
  const Eigen::MatrixXd at = model.predict(0, model.nominal(), Context());
  const Eigen::MatrixXd r = model.measurements().front().measured - at;
  std::vector<Eigen::MatrixXd> columns;
  for (const int p : {1, 2}) {
    Eigen::VectorXd moved = model.nominal();
    moved[p] = 1;
    columns.push_back(model.predict(0, moved, Context()) - at);
  }
  const GramByStructure gram = misfit.gram(r, columns);
  Hypothesis none, bump;
  bump.causes = {0};
  weigh(model, gram, {1, 2}, model.nominal(), none);
  weigh(model, gram, {1, 2}, model.nominal(), bump);
  const auto dense = [&](bool with_bump) {
    double log_sum = -1e300, prior_sum = -1e300;
    const auto sizes = structure_sizes(model);
    for (std::size_t t = 0; t < sizes.size(); ++t) {
      const Eigen::MatrixXd inverse = inverse_covariance(one, 30, t);
      Eigen::MatrixXd C = Eigen::MatrixXd::Zero(60, 60);
      C.topLeftCorner(30, 30) = C.bottomRightCorner(30, 30) = inverse.inverse();
      const auto stacked = [](const Eigen::MatrixXd& m) {
        return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(m.data(), m.size()));
      };
      C += stacked(columns[0]) * stacked(columns[0]).transpose();
      if (with_bump) C += stacked(columns[1]) * stacked(columns[1]).transpose();
      const double prior = -0.5 * std::pow(sizes[t] / model.known_misfit(), 2);
      const double log_p = -0.5 * (stacked(r).dot(C.ldlt().solve(stacked(r))) + std::log(C.determinant()));
      const auto add = [](double a, double b) { return std::max(a, b) + std::log1p(std::exp(-std::abs(a - b))); };
      log_sum = add(log_sum, prior + log_p);
      prior_sum = add(prior_sum, prior);
    }
    return log_sum - prior_sum;
  };
  CHECK_THAT(none.log_evidence, WithinAbs(dense(false), 1e-4 * std::abs(dense(false))));
  CHECK_THAT(bump.log_evidence, WithinAbs(dense(true), 1e-4 * std::abs(dense(true))));
  CHECK(bump.log_evidence > none.log_evidence + 10);
  CHECK_THAT(bump.u[2], WithinAbs(0.5, 0.1));
}

}  // namespace
}  // namespace formwright
