// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Which simulation causes are looked for with: the usual one, or one that does more of what it leaves out
// (ForwardModel::extensions). What is missing there would else be blamed on the machine.
#include <string>
#include <vector>

#include "evidence/fit/forward_model.h"

namespace formwright {

/// An extension that was tried, on top of those taken before it.
struct TriedExtension {
  SimulationExtension extension;
  bool fitted = false;           // else it got one look
  double log_evidence_gain = 0;  // whatever cause may be at work as well
  double error_before_mm = 0,
         error_after_mm = 0;  // mean distance, calibrated (after one look: not anew), without and with it
  bool taken = false;
  bool advised = false;  // not taken, but one look promises that it would fit better
};

struct SimulationChoice {
  std::vector<TriedExtension> tried;  // in the order in which they were
  int simulations = 0;
  double seconds = 0;
  Eigen::VectorXd u;  // where the chosen one is calibrated; empty where there was nothing to choose

  /// Names of those taken, in that order.
  std::vector<std::string> taken() const;
};

/// Calibrates `model` and its extensions, and takes what raises the marginal likelihood clearly,
/// every cause left free, the best first and one at a time. A point is an outlier only where neither of two simulations
/// explains it. Throws Error{could_not_solve, cancelled}.
SimulationChoice choose_simulation(const ForwardModel& model, Context& context);

}  // namespace formwright
