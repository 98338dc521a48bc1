// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Which points of an object to measure where only a few can be, and which causes these would show.
#include <vector>

#include "evidence/fit/simulation_bag.h"

namespace formwright {

struct MeasuringPlanOptions {
  int points = 10;                   // to choose
  Eigen::Index measured = 0;         // rows from 0 on that are measured already
  Eigen::Index measured_others = 0;  // rows of the object's other quantities that are measured; the rest is going to be
  double min_distance = 0;           // between chosen points, in the unit of Measurement::place
};

/// What a set of points tells of one cause.
struct CauseOutlook {
  int cause = 0;
  double usual_strength = 0;         // Cause::unit: how strong it may well be (the prior of its first parameter)
  double min_visible_strength = 0;   // with the points of the plan; infinite where the material imitates the cause
  double best_visible_strength = 0;  // with all candidates
  int closest_cause = -1;            // the cause that does most nearly the same to these points; -1 where it is alone
  double similarity = 0;             // of that one, 1: the same

  bool shows() const { return min_visible_strength <= usual_strength; }
};

struct MeasuringPlan {
  std::vector<Eigen::MatrixXd> expected;  // n x d of each measurement: what is expected without any cause
  std::vector<Eigen::Index> chosen;       // rows, the most telling first
  std::vector<double> information;     // nats about the causes, of measured points, of the other quantities, and of the
                                       // first 1, 2, ... chosen
  double information_of_measured = 0;  // of what is measured already
  double information_of_all = 0;       // of all candidates together
  std::vector<CauseOutlook> causes;    // in the model's order
};

/// Chooses rows of the model's first measurement, one after the other, each the one that tells most about the causes
/// beside those before it (PointInformation). Other quantities of the same object (Measurement::places_index) count as
/// measured.
/// Sensitivities are taken about two materials, the set-up's and a stiffer one, and the mean of what they say counts:
/// what contact and mesh make is different about each. `Measurement::sigma` says how well each point can be measured, >
/// 0; `measured` itself is not looked at. Fewer are chosen where `min_distance` leaves no more. Throws
/// Error{could_not_solve} where the model has no answer at its nominal parameters, Error{cancelled}.
MeasuringPlan plan_measuring(SimulationBag& bag, const MeasuringPlanOptions& options, Context& context);

}  // namespace formwright
