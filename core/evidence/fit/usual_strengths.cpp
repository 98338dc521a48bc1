// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/fit/usual_strengths.h"

namespace formwright {

std::vector<Sensitivities> at_usual_strengths(SimulationBag& bag, const Predictions& at_nominal,
                                              std::vector<Sensitivities> sensitivities, Context& context,
                                              const std::string& stage) {
  const ForwardModel& model = bag.model();
  std::vector<std::size_t> one_sided;
  std::vector<Eigen::VectorXd> points;
  for (std::size_t p = 0; p < model.parameters().size(); ++p) {
    const ModelParameter& parameter = model.parameters()[p];
    if (parameter.role != ParameterRole::effect || !parameter.one_sided()) continue;
    one_sided.push_back(p);
    points.push_back(model.nominal());
    points.back()[static_cast<Eigen::Index>(p)] = parameter.prior_sd;
    points.back() = within_ranges(model, points.back());
  }
  const auto predictions = bag.run(points, context, stage);
  for (std::size_t i = 0; i < one_sided.size(); ++i) {
    if (!predictions[i]) continue;
    const auto p = static_cast<Eigen::Index>(one_sided[i]);
    for (std::size_t object = 0; object < sensitivities.size(); ++object)
      sensitivities[object][one_sided[i]] =
          ((*predictions[i])[object] - at_nominal[object]) / (points[i][p] - model.nominal()[p]);
  }
  return sensitivities;
}

}  // namespace formwright
