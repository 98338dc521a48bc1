// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Fits a model's base parameters to measured objects, and says which of them the data cannot tell. Thesis 4.2.3.
#include "evidence/fit/structured_objective.h"

namespace formwright {

struct ProfilePoint {
  double value = 0;           // of the parameter, the others fitted to it
  double log_likelihood = 0;  // less that of the best: 0 at the best, negative elsewhere
};

struct ParameterProfile {
  int parameter = 0;
  double best = 0, low = 0, high = 0;  // value and 95 % interval, cut off at the range that was searched
  bool identified = true;              // the interval is much narrower than the range
  std::vector<ProfilePoint> points;    // ascending
};

struct Calibration {
  Eigen::VectorXd u;
  Predictions predictions;
  double error_nominal = 0, error = 0;  // mean distance of all points (thesis 4.2.3), before and after
  double objective = 0;
  std::vector<NoiseEstimate> noise;        // each object
  std::vector<ParameterProfile> profiles;  // base parameters; empty after a grid search
  int simulations = 0;
  double seconds = 0;
};

/// By Levenberg and Marquardt from the nominal values or, where it is better and not empty, from `start`. Throws
/// Error{could_not_solve, cancelled}.
Calibration calibrate(SimulationBag& bag, Context& context, const Eigen::VectorXd& start = {});

/// The same without intervals: `profiles` stays empty.
Calibration calibrate_quickly(SimulationBag& bag, Context& context, const Eigen::VectorXd& start = {});

/// As in [Sch18]: `per_side` values of each of `grid_parameters` over `low` to `high` (values; as many as
/// parameters), at each the best small translation of the mould by `place_parameters` (at most 2, each within `reach`
/// of nominal, linearised about the nominal point).
struct GridAxis {
  int parameter;
  double low, high;
};
Calibration grid_search(SimulationBag& bag, const std::vector<GridAxis>& axes, int per_side,
                        const std::vector<int>& place_parameters, double reach, Context& context);

/// Mean Euclidean distance over all points of all measurements of places.
double mean_distance(const ForwardModel& model, const Predictions& residuals);

}  // namespace formwright
