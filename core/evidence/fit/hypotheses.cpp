// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/fit/hypotheses.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace formwright {
namespace {

/// Multiples of the known misfit. A cause that is right leaves about 1.
constexpr std::array<double, 10> multiples{0, 0.35, 0.7, 1, 1.4, 2, 3, 4.5, 7, 12};
constexpr double unknown_from = 2;

double log_sum_exp(const std::vector<double>& values) {
  const double largest = *std::max_element(values.begin(), values.end());
  double sum = 0;
  for (const double v : values) sum += std::exp(v - largest);
  return largest + std::log(sum);
}

double normal_cdf(double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); }

/// Of `columns`, which have a say where `causes` are at work.
std::vector<int> indices_of(const ForwardModel& model, const std::vector<int>& columns,
                            const std::vector<int>& causes) {
  std::vector<int> chosen;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const bool always = model.parameters()[static_cast<std::size_t>(columns[c])].sd_without_cause() > 0;
    if (always || model.is_of(columns[c], causes)) chosen.push_back(static_cast<int>(c));
  }
  return chosen;
}

struct Weighed {
  double log_evidence;
  Eigen::VectorXd step;
};

/// Marginal likelihood at one size of structure, and the most probable step.
Weighed weigh_at(const ForwardModel& model, const Eigen::MatrixXd& gram, double log_determinant,
                 const std::vector<int>& columns, const std::vector<int>& chosen, const std::vector<int>& causes,
                 const Eigen::VectorXd& u0) {
  const auto k = static_cast<Eigen::Index>(chosen.size());
  Eigen::MatrixXd A(k, k);
  Eigen::VectorXd b(k), precision(k), offset(k);
  for (Eigen::Index i = 0; i < k; ++i) {
    const int column = chosen[static_cast<std::size_t>(i)], p = columns[static_cast<std::size_t>(column)];
    const ModelParameter& parameter = model.parameters()[static_cast<std::size_t>(p)];
    precision[i] = std::pow(model.is_of(p, causes) ? parameter.prior_sd : parameter.sd_without_cause(), -2);
    offset[i] = u0[p];
    b[i] = gram(1 + column, 0) - precision[i] * offset[i];
    for (Eigen::Index j = 0; j < k; ++j) A(i, j) = gram(1 + column, 1 + chosen[static_cast<std::size_t>(j)]);
    A(i, i) += precision[i];
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(A);
  Weighed result{0, factor.solve(b)};
  // One-sided parameters: what lies on the wrong side of zero does not count.
  double log_share = 0;
  const Eigen::MatrixXd covariance = factor.solve(Eigen::MatrixXd::Identity(k, k));
  for (Eigen::Index i = 0; i < k; ++i) {
    const ModelParameter& parameter = model.parameters()[static_cast<std::size_t>(
        columns[static_cast<std::size_t>(chosen[static_cast<std::size_t>(i)])])];
    if (!parameter.one_sided() ||
        !model.is_of(columns[static_cast<std::size_t>(chosen[static_cast<std::size_t>(i)])], causes))
      continue;
    log_share += std::log(std::max(1e-30, 2 * normal_cdf((offset[i] + result.step[i]) / std::sqrt(covariance(i, i)))));
  }
  const double quadratic = gram(0, 0) + offset.cwiseProduct(precision).dot(offset) - b.dot(result.step);
  const double occam =
      2 * Eigen::MatrixXd(factor.matrixL()).diagonal().array().log().sum() - precision.array().log().sum();
  result.log_evidence = -0.5 * (quadratic + log_determinant + occam) + log_share;
  return result;
}

}  // namespace

std::vector<double> structure_sizes(const ForwardModel& model) {
  std::vector<double> sizes;
  for (const double multiple : multiples) sizes.push_back(multiple * model.known_misfit());
  return sizes;
}

void weigh(const ForwardModel& model, const GramByStructure& gram, const std::vector<int>& columns,
           const Eigen::VectorXd& u0, Hypothesis& hypothesis) {
  const std::vector<int> chosen = indices_of(model, columns, hypothesis.causes);
  std::vector<double> terms, priors;
  std::vector<Weighed> weighed;
  for (std::size_t t = 0; t < multiples.size(); ++t) {
    const double multiple = multiples[t];
    double log_prior;
    if (hypothesis.unknown_structure)
      log_prior = multiple >= unknown_from ? 0 : -std::numeric_limits<double>::infinity();
    else log_prior = -0.5 * multiple * multiple;
    priors.push_back(log_prior);
    weighed.push_back(weigh_at(model, gram.gram[t], gram.log_determinant[t], columns, chosen, hypothesis.causes, u0));
    terms.push_back(log_prior + weighed.back().log_evidence);
  }
  hypothesis.log_evidence = log_sum_exp(terms) - log_sum_exp(priors);
  hypothesis.structure = 0;
  std::size_t best = 0;
  for (std::size_t t = 0; t < terms.size(); ++t) {
    hypothesis.structure += std::exp(terms[t] - log_sum_exp(terms)) * multiples[t] * model.known_misfit();
    if (terms[t] > terms[best]) best = t;
  }
  hypothesis.u = u0;
  for (std::size_t i = 0; i < chosen.size(); ++i)
    if (const int p = columns[static_cast<std::size_t>(chosen[i])];
        model.parameters()[static_cast<std::size_t>(p)].role != ParameterRole::effect ||
        model.is_of(p, hypothesis.causes))
      hypothesis.u[p] += weighed[best].step[static_cast<Eigen::Index>(i)];
  hypothesis.u = within_ranges(model, hypothesis.u);
}

std::vector<Hypothesis> all_hypotheses(const ForwardModel& model, bool pairs) {
  const auto count = static_cast<int>(model.causes().size());
  const auto with = [](std::vector<int> causes, bool unknown, double prior) {
    Hypothesis h;
    h.causes = std::move(causes);
    h.unknown_structure = unknown;
    h.log_prior = std::log(prior);
    return h;
  };
  std::vector<Hypothesis> list{with({}, false, 0.3), with({}, true, 0.1)};
  for (int a = 0; a < count; ++a) {
    list.push_back(with({a}, false, 0.4 / count));
    list.push_back(with({a}, true, 0.04 / count));
  }
  if (pairs)
    for (int a = 0; a < count; ++a)
      for (int b = a + 1; b < count; ++b) {
        list.push_back(with({a, b}, false, 0.15 / (0.5 * count * (count - 1))));
        list.push_back(with({a, b}, true, 0.01 / (0.5 * count * (count - 1))));
      }
  return list;
}

void normalise(std::vector<Hypothesis>& hypotheses) {
  std::vector<double> terms;
  for (const Hypothesis& h : hypotheses) terms.push_back(h.log_prior + h.log_evidence);
  const double total = log_sum_exp(terms);
  for (std::size_t i = 0; i < hypotheses.size(); ++i) hypotheses[i].probability = std::exp(terms[i] - total);
  std::stable_sort(hypotheses.begin(), hypotheses.end(),
                   [](const Hypothesis& a, const Hypothesis& b) { return a.probability > b.probability; });
}

namespace {

/// Of `columns`, those of base and discrepancy parameters.
std::vector<int> indices_of_no_cause(const ForwardModel& model, const std::vector<int>& columns) {
  std::vector<int> chosen;
  for (std::size_t c = 0; c < columns.size(); ++c)
    if (model.parameters()[static_cast<std::size_t>(columns[c])].role != ParameterRole::effect)
      chosen.push_back(static_cast<int>(c));
  return chosen;
}

/// Of `columns`, those of a cause's own parameters.
std::vector<int> indices_of_cause(const ForwardModel& model, const std::vector<int>& columns, int cause) {
  std::vector<int> chosen;
  for (std::size_t c = 0; c < columns.size(); ++c)
    if (model.is_of(columns[c], {cause})) chosen.push_back(static_cast<int>(c));
  return chosen;
}

/// Gram matrices of what causes do, less what base parameters and discrepancies can imitate as far as their priors let
/// them.
class Projection {
 public:
  Projection(const ForwardModel& model, const Eigen::MatrixXd& gram, const std::vector<int>& columns)
      : model_(model), G_(gram), columns_(columns), others_(indices_of_no_cause(model, columns)) {
    Eigen::MatrixXd base = block(others_, others_);
    for (std::size_t i = 0; i < others_.size(); ++i) {
      const double sd =
          model.parameters()[static_cast<std::size_t>(columns[static_cast<std::size_t>(others_[i])])].prior_sd;
      base(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) += 1 / (sd * sd);
    }
    factor_.compute(base);
  }
  Eigen::MatrixXd operator()(int cause_a, int cause_b) const {
    const std::vector<int> a = indices_of_cause(model_, columns_, cause_a),
                           b = indices_of_cause(model_, columns_, cause_b);
    return block(a, b) - block(a, others_) * factor_.solve(block(others_, b));
  }

 private:
  Eigen::MatrixXd block(const std::vector<int>& rows, const std::vector<int>& cols) const {
    Eigen::MatrixXd M(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(cols.size()));
    for (Eigen::Index i = 0; i < M.rows(); ++i)
      for (Eigen::Index j = 0; j < M.cols(); ++j)
        M(i, j) = G_(1 + rows[static_cast<std::size_t>(i)], 1 + cols[static_cast<std::size_t>(j)]);
    return M;
  }

  const ForwardModel& model_;
  const Eigen::MatrixXd& G_;
  const std::vector<int>& columns_;
  std::vector<int> others_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

}  // namespace

double similarity(const ForwardModel& model, const GramByStructure& gram, std::size_t structure,
                  const std::vector<int>& columns, int cause_a, int cause_b) {
  const Projection projected(model, gram.gram[structure], columns);
  // The largest canonical correlation of the two spans.
  const auto root_inverse = [](const Eigen::MatrixXd& M) -> Eigen::MatrixXd {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(M);
    const double largest = std::max(eigen.eigenvalues().maxCoeff(), 1e-300);
    return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(1e-9 * largest).cwiseSqrt().cwiseInverse().asDiagonal() *
           eigen.eigenvectors().transpose();
  };
  const Eigen::MatrixXd correlation = root_inverse(projected(cause_a, cause_a)) * projected(cause_a, cause_b) *
                                      root_inverse(projected(cause_b, cause_b));
  return std::min(1.0, Eigen::JacobiSVD<Eigen::MatrixXd>(correlation).singularValues().maxCoeff());
}

double min_visible_strength(const ForwardModel& model, const GramByStructure& gram, std::size_t structure,
                            const std::vector<int>& columns, int cause) {
  constexpr double deviations = 4;  // of the strength: a log evidence of 8
  const Eigen::MatrixXd& G = gram.gram[structure];
  const auto k = static_cast<Eigen::Index>(columns.size());
  const std::vector<int> others = indices_of_no_cause(model, columns), own = indices_of_cause(model, columns, cause);
  Eigen::VectorXd precision(static_cast<Eigen::Index>(others.size()));
  for (std::size_t i = 0; i < others.size(); ++i)
    precision[static_cast<Eigen::Index>(i)] = std::pow(
        model.parameters()[static_cast<std::size_t>(columns[static_cast<std::size_t>(others[i])])].prior_sd, -2);
  // At either place: what the others do of it, and what remains of it.
  const auto block = [&](const std::vector<int>& rows, Eigen::Index place_of_rows, const std::vector<int>& cols,
                         Eigen::Index place_of_cols) {
    Eigen::MatrixXd M(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(cols.size()));
    for (Eigen::Index i = 0; i < M.rows(); ++i)
      for (Eigen::Index j = 0; j < M.cols(); ++j)
        M(i, j) = G(1 + place_of_rows * k + rows[static_cast<std::size_t>(i)],
                    1 + place_of_cols * k + cols[static_cast<std::size_t>(j)]);
    return M;
  };
  // Where the material was measured, the calibrated one may be far from it, and it is the measured one that counts.
  const bool measured = std::any_of(model.parameters().begin(), model.parameters().end(),
                                    [](const ModelParameter& p) { return p.was_measured; });
  const Eigen::Index first = measured ? 1 : 0;
  const auto imitated = [&](Eigen::Index place) -> Eigen::MatrixXd {
    Eigen::MatrixXd A = block(others, place, others, place);
    A.diagonal() += precision;
    return A.llt().solve(block(others, place, own, place));
  };
  const Eigen::MatrixXd X = imitated(first), Y = imitated(1);
  const Eigen::MatrixXd shared = block(own, first, own, 1) - block(own, first, others, 1) * Y -
                                 X.transpose() * block(others, first, own, 1) +
                                 X.transpose() * (block(others, first, others, 1) * Y + precision.asDiagonal() * Y);
  const double weakest =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(0.5 * (shared + shared.transpose())).eigenvalues().minCoeff();
  if (!(weakest > 0)) return std::numeric_limits<double>::infinity();
  double usual = 0;
  for (const int p : model.causes()[static_cast<std::size_t>(cause)].parameters)
    usual = std::max(usual, model.parameters()[static_cast<std::size_t>(p)].usual_sd);
  return deviations * std::sqrt(1 / weakest + usual * usual);
}

}  // namespace formwright
