// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/fit/probing.h"

#include <algorithm>

#include "base/error.h"

namespace formwright {
namespace {

constexpr double shorter = 0.25;  // of a step that has no answer on either side: a shorter one may have one

}  // namespace

ProbingInProgress::ProbingInProgress(const ForwardModel& model, Eigen::VectorXd u, std::vector<int> free)
    : model_(model), u_(std::move(u)), free_(std::move(free)) {
  for (const int p : free_)
    for (const double sign : {1.0, -1.0}) {
      const ModelParameter& parameter = model.parameters()[static_cast<std::size_t>(p)];
      Eigen::VectorXd moved = u_;
      moved[p] += sign * parameter.probe;
      // Discrepancies are switches: there is no other side.
      const bool switched = parameter.role == ParameterRole::discrepancy && sign < 0;
      points_.push_back(switched ? u_ : within_ranges(model, moved));
    }
  wanted_ = points_;
}

void ProbingInProgress::take(std::vector<std::optional<Predictions>> made) {
  wanted_.clear();
  if (!predictions_.empty()) {
    for (std::size_t k = 0; k < again_.size(); ++k) predictions_[again_[k]] = std::move(made[k]);
    return;
  }
  predictions_ = std::move(made);
  for (std::size_t i = 0; i < points_.size(); i += 2) {
    if (has_answer(i) || has_answer(i + 1)) continue;
    for (const std::size_t side : {i, i + 1}) {
      if (predictions_[side]) continue;
      again_.push_back(side);
      points_[side] = u_ + shorter * (points_[side] - u_);
      wanted_.push_back(points_[side]);
    }
  }
}

Probing ProbingInProgress::result(const Predictions& at_u) const {
  Probing result{std::vector<Sensitivities>(at_u.size()), std::vector<std::vector<Eigen::MatrixXd>>(at_u.size())};
  for (std::size_t i = 0; i < free_.size(); ++i) {
    const Eigen::Index p = free_[i];
    const bool plus = has_answer(2 * i), minus = has_answer(2 * i + 1);
    if (!plus && !minus)
      throw Error(
          ErrorCode::could_not_solve, "",
          "The simulation fails on both sides of " + model_.parameters()[static_cast<std::size_t>(p)].label + ".");
    const double upper = plus ? points_[2 * i][p] : u_[p], lower = minus ? points_[2 * i + 1][p] : u_[p];
    for (std::size_t object = 0; object < at_u.size(); ++object) {
      const Eigen::MatrixXd& above = plus ? (*predictions_[2 * i])[object] : at_u[object];
      const Eigen::MatrixXd& below = minus ? (*predictions_[2 * i + 1])[object] : at_u[object];
      result.sensitivities[object].push_back((above - below) / (upper - lower));
      if (plus && minus) result.bends[object].push_back(0.5 * (above + below) - at_u[object]);
    }
  }
  return result;
}

Probing probe_around(SimulationBag& bag, const Eigen::VectorXd& u, const Predictions& at_u,
                     const std::vector<int>& free, Context& context, const std::string& stage) {
  ProbingInProgress probing(bag.model(), u, free);
  while (!probing.wanted().empty()) probing.take(bag.run(probing.wanted(), context, stage));
  return probing.result(at_u);
}

std::vector<Sensitivities> sensitivities_at(SimulationBag& bag, const Eigen::VectorXd& u, const Predictions& at_u,
                                            const std::vector<int>& free, Context& context, const std::string& stage) {
  return probe_around(bag, u, at_u, free, context, stage).sensitivities;
}

std::vector<Sensitivities> sensitivities_of(const std::vector<int>& wanted, const std::vector<Sensitivities>& all,
                                            const std::vector<int>& columns) {
  std::vector<Sensitivities> result(all.size());
  for (const int p : wanted) {
    const auto at = static_cast<std::size_t>(std::find(columns.begin(), columns.end(), p) - columns.begin());
    for (std::size_t object = 0; object < all.size(); ++object) result[object].push_back(all[object][at]);
  }
  return result;
}

std::vector<Sensitivities> side_by_side(std::vector<Sensitivities> a, const std::vector<Sensitivities>& b) {
  for (std::size_t object = 0; object < a.size(); ++object)
    a[object].insert(a[object].end(), b[object].begin(), b[object].end());
  return a;
}

std::vector<int> joined(std::vector<int> a, const std::vector<int>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

}  // namespace formwright
