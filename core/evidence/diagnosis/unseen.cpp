// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/diagnosis/unseen.h"

#include <algorithm>

#include "base/error.h"

namespace formwright {
namespace {

/// The coordinate of `to` for a value of `from`: what an object's own set-up says of an effect stays, and what was
/// found comes on top.
double carried_over(const ModelParameter& to, const ModelParameter& from, double value) {
  if (to.role == ParameterRole::effect && to.nominal != from.nominal)
    value = std::clamp(to.nominal + value - from.nominal, to.low, to.high);
  return to.coordinate(value);
}

}  // namespace

UnseenObjects predict_unseen(const ForwardModel& unseen, const ForwardModel& from, const Diagnosis& found,
                             Context& context) {
  const ForwardModel& model = found.looked_again && unseen.finer() != nullptr ? *unseen.finer() : unseen;
  const auto translated = [&](const Eigen::VectorXd& u) {
    Eigen::VectorXd own = model.nominal();
    for (std::size_t p = 0; p < model.parameters().size(); ++p)
      for (std::size_t q = 0; q < from.parameters().size(); ++q)
        if (model.parameters()[p].name == from.parameters()[q].name &&
            model.parameters()[p].role != ParameterRole::discrepancy)
          own[static_cast<Eigen::Index>(p)] = carried_over(model.parameters()[p], from.parameters()[q],
                                                           from.parameters()[q].value(u[static_cast<Eigen::Index>(q)]));
    return own;
  };
  SimulationBag bag(model);
  const auto predictions = bag.run(std::vector<Eigen::VectorXd>{translated(found.base.u), translated(found.extended.u)},
                                   context, "Predicting the validation object");
  if (!predictions[0] || !predictions[1])
    throw Error(ErrorCode::could_not_solve, "unseen",
                "The validation object cannot be simulated with the fitted parameters: check its mould and set-up.");
  UnseenObjects result{{}, std::move(*predictions[0]), std::move(*predictions[1]), {}};
  const Predictions after = residuals(model, result.extended);
  for (std::size_t object = 0; object < after.size(); ++object)
    result.weights.push_back(estimate_noise(model.measurements()[object], after[object]).weights);
  result.gain = compare_distances(model, point_errors(residuals(model, result.base), result.weights),
                                  point_errors(after, result.weights));
  return result;
}

}  // namespace formwright
