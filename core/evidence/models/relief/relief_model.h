// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Photographs of finished reliefs in known light as a forward model: from how they were made, lit and looked at to the
// brightness of their points.
#include <vector>

#include "evidence/fit/forward_model.h"
#include "evidence/models/relief/photographed_relief.h"

namespace formwright {

/// The base model is a matt surface: brightness = exposure (ambient + (1 - ambient) max(0, n . l)), without shadows
/// that one part casts on another. Every picture has an exposure of its own, the one with which it is nearest to what
/// was measured: it is eliminated as the linear parameter of a separable fit (Golub and Pereyra 1973). Points beside
/// the relief are left out. Causes: light_direction, light_distance, gloss, cast_shadow, printer_blur, depth_shrinkage,
/// viewer_offset.
class ReliefModel : public ForwardModel {
 public:
  /// At least one picture, of at least 30 points on its relief each. Throws Error{invalid_input, "object"}.
  explicit ReliefModel(std::vector<PhotographedRelief> pictures);

  /// Of the points that were given, in all pictures.
  int points_beside() const { return points_beside_; }

  const std::vector<ModelParameter>& parameters() const override { return parameters_; }
  const std::vector<Cause>& causes() const override { return causes_; }
  const std::vector<Measurement>& measurements() const override { return measurements_; }
  Eigen::MatrixXd predict(int object, const Eigen::VectorXd& u, const Context& context) const override;
  double known_misfit() const override { return 0.01; }

 private:
  std::vector<PhotographedRelief> pictures_;
  int points_beside_ = 0;
  std::vector<ModelParameter> parameters_;
  std::vector<Cause> causes_;
  std::vector<Measurement> measurements_;
};

}  // namespace formwright
