// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/explanations/wide_secants.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace formwright {
namespace {

std::vector<int> parameters_of(const ForwardModel& model, const std::vector<int>& causes) {
  std::vector<int> all;
  for (const int cause : causes) all = joined(all, model.causes()[static_cast<std::size_t>(cause)].parameters);
  return all;
}

/// Without the parameter; a step away where it is nearly so already.
double far_end(const ModelParameter& parameter, double u) {
  if (std::abs(u) >= parameter.probe) return 0;
  const double end = u - std::copysign(parameter.probe, u);
  return end >= parameter.low_u() && end <= parameter.high_u() ? end : u + std::copysign(parameter.probe, u);
}

}  // namespace

std::optional<Eigen::VectorXd> step_on_wide_secants(SimulationBag& bag, const Explanations& tried,
                                                    const std::vector<int>& causes, OtherSimulation other,
                                                    Context& context) {
  const ForwardModel& model = bag.model();
  const ParameterFit& fit = tried.refit_of(causes).fit;
  const std::vector<int> own = parameters_of(model, causes);
  std::vector<Eigen::VectorXd> points{fit.u};  // then the far end of each parameter
  if (other) points.front()[*other] = model.parameters()[static_cast<std::size_t>(*other)].probe;
  for (const int p : own) {
    points.push_back(points.front());
    points.back()[p] = far_end(model.parameters()[static_cast<std::size_t>(p)], fit.u[p]);
  }
  const auto made = bag.run(points, context, measuring_strengths);
  if (std::any_of(made.begin(), made.end(), [](const auto& m) { return !m; })) return {};
  std::vector<Sensitivities> secants = fit.sensitivities;
  for (std::size_t k = 0; k < own.size(); ++k) {
    const auto column =
        static_cast<std::size_t>(std::find(fit.free.begin(), fit.free.end(), own[k]) - fit.free.begin());
    const double width = points[0][own[k]] - points[1 + k][own[k]];
    for (std::size_t object = 0; object < secants.size(); ++object)
      secants[object][column] = ((*made[0])[object] - (*made[1 + k])[object]) / width;
  }
  // Structure of unknown origin has no say: smooth, it would count what causes move less than the leaps, which are
  // rough.
  constexpr std::size_t no_structure = 0;  // MisfitOfAll::sizes() begins with it
  const StructuredObjective objective(model, tried.misfit(), no_structure,
                                      {{}, std::vector<Sensitivities>(secants.size())});
  Eigen::VectorXd g;
  Eigen::MatrixXd H;
  objective.quadratic(residuals(model, *made[0]), secants, fit.free, fit.u, g, H);
  Eigen::VectorXd u = fit.u;
  u(fit.free) -= H.llt().solve(g);
  if (!u.allFinite()) return {};
  return within_ranges(model, u);
}

}  // namespace formwright
