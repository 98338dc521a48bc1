// SPDX-License-Identifier: GPL-3.0-or-later
#include "foreign_laboratory/sheet/sheet_motion.h"

#include <cmath>
#include <stdexcept>
#include <utility>

namespace formwright::foreign_laboratory {

SheetMotion::SheetMotion(Membrane membrane, std::vector<char> held, double z_mm, const MotionSettings& settings)
    : membrane_(std::move(membrane)), held_(std::move(held)), settings_(settings) {
  const Grid& grid = membrane_.grid();
  if (held_.size() != static_cast<std::size_t>(grid.node_count()))
    throw std::invalid_argument("held: give one value a node");
  if (!(settings.mass_scale > 0) || !(settings.step_share > 0) || !(settings.step_share <= 1))
    throw std::invalid_argument("settings: give a positive mass_scale, and a step_share between 0 and 1");
  place_.resize(3, grid.node_count());
  for (int node = 0; node < grid.node_count(); ++node) place_.col(node) << grid.flat_mm(node), z_mm;
  velocity_ = force_ = Points::Zero(3, grid.node_count());
  mass_t_ = settings.mass_scale * membrane_.mass_t();
}

void SheetMotion::begin_step() {
  weight_per_mass_ = settings_.gravity_mm_per_s2 / settings_.mass_scale;
  last_step_s_ = step_s_;
  if (steps_until_check_ > 0) {
    --steps_until_check_;
    return;
  }
  constexpr int steps_between_checks = 50;
  steps_until_check_ = steps_between_checks;
  const double squared = membrane_.max_squared_frequency(place_) / settings_.mass_scale;
  if (!std::isfinite(squared))
    throw std::runtime_error("step_share: the sheet's shape is no longer finite; give a smaller share");
  // 2/omega is the largest stable step of central differences. The step has a margin, so that it changes seldom: energy
  // is kept to second order only while it stays.
  constexpr double margin = 0.05, growth = 1.15;
  const double largest = settings_.step_share * 2 / std::sqrt(squared);
  if (step_s_ > 0 && largest >= step_s_ && largest < growth * step_s_) return;
  const double step = (1 - margin) * largest;
  step_s_ = step;
  membrane_.set_step(step);
}

void SheetMotion::end_step(double pressure_mpa) {
  time_s_ += step_s_;
  membrane_.advance(place_, pressure_mpa, force_);
}

}  // namespace formwright::foreign_laboratory
