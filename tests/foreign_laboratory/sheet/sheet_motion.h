// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The membrane's motion by central differences ([BLME14], box 6.1): forces at the end of
// a step give the velocity in the middle of the next. Masses may be larger than the sheet's, which makes steps longer;
// weight is the sheet's own.
#include <vector>

#include "foreign_laboratory/sheet/membrane.h"

namespace formwright::foreign_laboratory {

inline constexpr double gravity_mm_per_s2 = 9810;

struct MotionSettings {
  double mass_scale = 1;         // inertia over that of the sheet
  double damping_per_s = 0;      // force minus this times mass times velocity
  double gravity_mm_per_s2 = 0;  // downwards
  double step_share = 0.8;       // of the largest stable step
};

class SheetMotion {
 public:
  /// At rest and flat at height `z_mm`. `held`: one a node, those do not move by themselves.
  SheetMotion(Membrane membrane, std::vector<char> held, double z_mm, const MotionSettings& settings);

  /// One step under `pressure_mpa` from above. `constrain(node, place, velocity)` may change the velocity with which a
  /// free node leaves `place`.
  template <class Constrain>
  void step(double pressure_mpa, Constrain&& constrain) {
    begin_step();
    // From the middle of the last step to the middle of this one.
    const double seconds = 0.5 * (last_step_s_ + step_s_);
    const double half = 0.5 * settings_.damping_per_s * seconds;
    for (int node = 0; node < membrane_.grid().node_count(); ++node) {
      if (held_[static_cast<std::size_t>(node)]) {
        place_.col(node) += step_s_ * velocity_.col(node);
        continue;
      }
      Eigen::Vector3d acceleration = force_.col(node) / mass_t_[node];
      acceleration.z() -= weight_per_mass_;
      Eigen::Vector3d velocity = ((1 - half) * velocity_.col(node) + seconds * acceleration) / (1 + half);
      constrain(node, Eigen::Vector3d(place_.col(node)), velocity);
      velocity_.col(node) = velocity;
      place_.col(node) += step_s_ * velocity;
    }
    end_step(pressure_mpa);
  }
  void step(double pressure_mpa) {
    step(pressure_mpa, [](int, const Eigen::Vector3d&, Eigen::Vector3d&) {});
  }

  Membrane& membrane() { return membrane_; }
  const Membrane& membrane() const { return membrane_; }
  MotionSettings& settings() { return settings_; }
  Points& place() { return place_; }
  const Points& place() const { return place_; }
  Points& velocity() { return velocity_; }        // in the middle of the last step
  const Points& force() const { return force_; }  // at the end of the last step, of stress and pressure
  double step_s() const { return step_s_; }
  double time_s() const { return time_s_; }

 private:
  void begin_step();
  void end_step(double pressure_mpa);

  Membrane membrane_;
  std::vector<char> held_;
  MotionSettings settings_;
  Points place_, velocity_, force_;
  Eigen::VectorXd mass_t_;
  double last_step_s_ = 0, step_s_ = 0, time_s_ = 0, weight_per_mass_ = 0;
  int steps_until_check_ = 0;
};

}  // namespace formwright::foreign_laboratory
