// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/fit/usual_strengths.h"

namespace formwright {
namespace {

constexpr double usual_multiples[] = {0.5, 1, 2};
constexpr double much_left = 10;  // known misfits
constexpr double much_nearer = 0.5;

}  // namespace

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

std::vector<Eigen::VectorXd> strengths_to_start_from(const ForwardModel& model, const std::vector<int>& causes) {
  std::vector<Eigen::VectorXd> strengths;
  for (const double multiple : usual_multiples) {
    Eigen::VectorXd u = model.nominal();
    for (const int cause : causes)
      for (const int p : model.causes()[static_cast<std::size_t>(cause)].parameters)
        u[p] = multiple * model.parameters()[static_cast<std::size_t>(p)].prior_sd;
    strengths.push_back(within_ranges(model, u));
  }
  return strengths;
}

std::optional<StrongCause> strong_cause_instead_of(double calibrated, SimulationBag& bag, const FitObjective& objective,
                                                   Context& context, const std::string& stage) {
  const ForwardModel& model = bag.model();
  if (calibrated < much_left * model.known_misfit()) return std::nullopt;
  std::vector<Eigen::VectorXd> points;
  std::vector<int> cause_at;
  for (int cause = 0; cause < static_cast<int>(model.causes().size()); ++cause) {
    if (!model.has_one_sign({cause})) continue;
    for (Eigen::VectorXd& u : strengths_to_start_from(model, {cause})) {
      points.push_back(std::move(u));
      cause_at.push_back(cause);
    }
  }
  const auto made = bag.run(points, context, stage);
  std::optional<StrongCause> nearest;
  double lowest = much_nearer * calibrated;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!made[i]) continue;
    const double value = objective.value(residuals(model, *made[i]), points[i]);
    if (!(value < lowest)) continue;
    lowest = value;
    nearest = StrongCause{cause_at[i], points[i], *made[i]};
  }
  return nearest;
}

}  // namespace formwright
