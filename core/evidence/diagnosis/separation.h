// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Which further measurement would tell two causes apart: predicted by the model before anyone makes it.
#include <memory>

#include "evidence/diagnosis/diagnosis.h"

namespace formwright {

/// A measurement that could be made, as a model that predicts it (its own `measured` is not looked at).
struct ProposedMeasurement {
  std::string what;                     // a sentence: what to do
  std::unique_ptr<ForwardModel> model;  // same parameters and causes as the diagnosed one
};

struct Separation {
  int proposal = -1;      // index; -1 where none helps
  double similarity = 1;  // of the two causes in old and proposed data together
};

/// Tries the proposals; `sigma` is the noise one expects of them.
Separation best_separation(SimulationBag& bag, const Diagnosis& diagnosis, const NotSeparable& pair,
                           const std::vector<ProposedMeasurement>& proposals, double sigma, Context& context);

}  // namespace formwright
