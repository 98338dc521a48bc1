// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/diagnosis/separation.h"

#include <algorithm>

#include "base/error.h"

namespace formwright {
namespace {

constexpr double worth_it = 0.05;  // that the likeness must fall by

}  // namespace

Separation best_separation(SimulationBag& bag, const Diagnosis& diagnosis, const NotSeparable& pair,
                           const std::vector<ProposedMeasurement>& proposals, double sigma, Context& context) {
  const ForwardModel& model = bag.model();
  std::vector<int> columns = model.base_parameters();
  for (const int cause : {pair.cause_a, pair.cause_b})
    for (const int p : model.causes()[static_cast<std::size_t>(cause)].parameters) columns.push_back(p);
  const auto gram_of = [&](SimulationBag& own,
                           const std::vector<Precisions>& precisions) -> std::optional<GramByStructure> {
    const auto at = own.run(diagnosis.base.u, context, "Looking for a measurement that distinguishes them");
    if (!at) return std::nullopt;
    try {
      const std::vector<Sensitivities> s = sensitivities_at(own, diagnosis.base.u, *at, columns, context,
                                                            "Looking for a measurement that distinguishes them");
      Predictions zero = *at;
      for (Eigen::MatrixXd& object : zero) object.setZero();
      return MisfitOfAll(own.model(), precisions).gram(zero, s);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::could_not_solve) throw;
      return std::nullopt;  // what is only proposed may be impossible
    }
  };
  std::vector<Precisions> precisions;
  for (std::size_t object = 0; object < diagnosis.noise.size(); ++object)
    precisions.push_back(isotropic(diagnosis.noise[object].weights, model.measurements()[object].measured.cols()));
  const auto present = gram_of(bag, precisions);
  Separation best;
  if (!present) return best;
  best.similarity = similarity(model, *present, diagnosis.structure, columns, pair.cause_a, pair.cause_b) - worth_it;
  for (std::size_t i = 0; i < proposals.size(); ++i) {
    const auto span = context.span(static_cast<double>(i) / static_cast<double>(proposals.size()),
                                   (static_cast<double>(i) + 1) / static_cast<double>(proposals.size()),
                                   "Looking for a measurement that distinguishes them");
    SimulationBag own(*proposals[i].model);
    std::vector<Precisions> expected;
    for (const Measurement& m : proposals[i].model->measurements()) {
      // Other quantities than places would be measured as well as they were.
      const Eigen::VectorXd deviations = m.is_place() ? Eigen::VectorXd::Constant(m.measured.rows(), sigma) : m.sigma;
      expected.push_back(isotropic(deviations.array().square().inverse().matrix(), m.measured.cols()));
    }
    auto together = gram_of(own, expected);
    if (!together) continue;
    *together += *present;
    const double alike = similarity(model, *together, diagnosis.structure, columns, pair.cause_a, pair.cause_b);
    if (alike < best.similarity) best = {static_cast<int>(i), alike};
  }
  return best;
}

}  // namespace formwright
