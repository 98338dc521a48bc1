// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Independent predictions of a forward model, made on all cores, each kept as soon as it is there.
#include <atomic>
#include <functional>
#include <map>
#include <mutex>
#include <optional>

#include "evidence/fit/forward_model.h"

namespace formwright {

/// Predictions of every measurement of a model at one u.
using Predictions = std::vector<Eigen::MatrixXd>;  // one n x d for each measurement

class SimulationBag {
 public:
  explicit SimulationBag(const ForwardModel& model) : model_(model) {}

  /// Predictions at each of `points`; those asked for before are not made again. `context` hears of progress from 0
  /// to 1. Where the model has no answer the place is empty. Throws Error{cancelled}.
  std::vector<std::optional<Predictions>> run(const std::vector<Eigen::VectorXd>& points, Context& context,
                                              const std::string& stage);
  std::optional<Predictions> run(const Eigen::VectorXd& point, Context& context, const std::string& stage);

  /// The same for several models at a time, each with points of its own, as one batch. The bags are different ones.
  /// `ahead` (as many lists, or none): points that may be asked for next; they are made by threads that would else be
  /// idle, and count as simulations once they are asked for.
  static std::vector<std::vector<std::optional<Predictions>>> run_together(
      const std::vector<SimulationBag*>& bags, const std::vector<std::vector<Eigen::VectorXd>>& points,
      Context& context, const std::string& stage, const std::vector<std::vector<Eigen::VectorXd>>& ahead = {});

  /// Drops what is kept: a long search asks for nothing twice.
  void forget() {
    known_.clear();
    made_ahead_.clear();
  }

  const ForwardModel& model() const { return model_; }
  int simulations() const { return simulations_; }

 private:
  struct Missing;

  const ForwardModel& model_;
  std::map<std::vector<double>, std::optional<Predictions>> known_;
  std::map<std::vector<double>, int> made_ahead_;  // and not asked for yet; of how many objects
  std::atomic<int> simulations_{0};
};

}  // namespace formwright
