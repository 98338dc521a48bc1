// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/diagnosis/cause_findings.h"

#include <algorithm>
#include <limits>

#include "evidence/explanations/fitted_strength.h"

namespace formwright {

void set_values(const ForwardModel& model, const Eigen::VectorXd& u, CauseFinding& finding) {
  finding.values = values_at(model, finding.cause, u);
  finding.strength = strength_of(finding.values);
}

std::vector<CauseFinding> cause_findings(Explanations& tried, const ParameterFit& base) {
  const ForwardModel& model = tried.model();
  const GramByStructure gram = tried.misfit().gram(residuals(model, base.predictions),
                                                   side_by_side(tried.sensitivities(), tried.usual_sensitivities()));
  const std::vector<double> like = tried.likenesses();
  double none = -std::numeric_limits<double>::infinity();
  for (const Hypothesis& h : tried.hypotheses())
    if (h.causes.empty()) none = std::max(none, h.log_evidence);
  std::vector<CauseFinding> findings;
  for (int cause = 0; cause < static_cast<int>(model.causes().size()); ++cause) {
    CauseFinding finding;
    finding.cause = cause;
    finding.likeness = like[static_cast<std::size_t>(cause)];
    finding.min_visible_strength =
        min_visible_strength(model, gram, tried.nearest_size(model.known_misfit()), tried.columns(), cause);
    const Hypothesis& likeliest = *std::find_if(
        tried.hypotheses().begin(), tried.hypotheses().end(),
        [&](const Hypothesis& h) { return std::find(h.causes.begin(), h.causes.end(), cause) != h.causes.end(); });
    finding.log_evidence = likeliest.log_evidence - none;
    finding.fitted = tried.is_refitted(likeliest.causes);
    if (finding.fitted) {
      const FittedStrength fitted = fitted_strength(model, tried, likeliest.causes, cause, likeliest.structure);
      finding.values = fitted.values;
      finding.strength = fitted.strength;
      finding.noise_deviation = fitted.noise_deviation;
      finding.low = finding.strength - normal_quantile * fitted.deviation;
      finding.high = finding.strength + normal_quantile * fitted.deviation;
    } else {
      // Far behind the others: where the linearised model has it.
      set_values(model, likeliest.u, finding);
      finding.low = finding.high = finding.strength;
    }
    findings.push_back(std::move(finding));
  }
  return findings;
}

}  // namespace formwright
