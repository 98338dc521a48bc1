// SPDX-License-Identifier: GPL-3.0-or-later
// How the virtual GRBL moves, and what its beam does meanwhile.
#include <algorithm>
#include <cmath>

#include "machines/virtual_grbl/virtual_grbl.h"

namespace formwright {
namespace {

double distance(const VirtualGrbl::Point& a, const VirtualGrbl::Point& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

}  // namespace

/// spindle_control.c spindle_compute_pwm_value: S with its override, between $31 and $30.
double VirtualGrbl::output_of(double power) const {
  const double low = settings_.at(31), high = settings_.at(30), asked = power * overrides_[2] / 100.0;
  if (low >= high || asked >= high) return high;
  return asked <= low ? (asked == 0 ? 0 : low) : asked;
}

void VirtualGrbl::set_spindle(int state, double power) {
  override_reports_ = 0;
  follows_speed_ = false;
  if (state != 5) output_spindle_ = state;
  // spindle_control.c spindle_set_state: with M4 a laser at rest is dark.
  reported_power_ = output_power_ = state == 5 || (laser_mode() && state == 4) ? 0 : output_of(power);
}

double VirtualGrbl::stopping_distance_mm() const {
  // To the end of what is planned, or to the first sharp corner.
  double sum = distance(counted_mm_, planner_.front().to_mm);
  for (std::size_t i = 0; i + 1 < planner_.size(); ++i) {
    const auto& a = i == 0 ? counted_mm_ : planner_[i - 1].to_mm;
    const auto &b = planner_[i].to_mm, &c = planner_[i + 1].to_mm;
    const double ab = distance(a, b), bc = distance(b, c);
    double dot = 0;
    for (std::size_t k = 0; k < 3; ++k) dot += (b[k] - a[k]) * (c[k] - b[k]);
    if (ab > 0 && bc > 0 && dot < 0.9 * ab * bc) break;
    sum += bc;
    if (sum > 200) break;  // more than any of its speeds needs
  }
  return sum;
}

void VirtualGrbl::move(double dt_s) {
  const bool moves = state_ == "Run" || state_ == "Jog" || (state_ == "Hold" && speed_mm_per_s_ > 0);
  if (moves && !planner_.empty()) run(dt_s);
  else if (moves) come_to_rest();
  if (speed_mm_per_s_ == 0) {
    beam_ = output_power_ > 0;
    if (beam_) record_beam(counted_mm_, dt_s, output_power_, false, -2);
  }
}

void VirtualGrbl::come_to_rest() {
  if (state_ == "Run" && rx_.empty() && !in_line_) ++ran_dry_;
  state_ = "Idle";
  speed_mm_per_s_ = 0;
  jog_cancelled_ = false;
  // stepper.c, "Segment buffer empty": what went with the speed goes out, what did not stays as it is.
  if (follows_speed_) output_power_ = reported_power_ = 0;
}

void VirtualGrbl::hold_is_complete() {
  speed_mm_per_s_ = 0;
  // config.h DISABLE_LASER_DURING_HOLD. Going on, the next block sets the beam anew.
  if (laser_mode() && modes_.spindle != 5) set_spindle(5, 0);
  else if (follows_speed_) output_power_ = reported_power_ = 0;
}

void VirtualGrbl::run(double dt_s) {
  const double a = options_.acceleration_mm_per_s2;
  const bool stops = state_ == "Hold" || jog_cancelled_;
  double left_s = dt_s;
  while (left_s > 1e-12 && !planner_.empty()) {
    const Block& block = planner_.front();
    const double nominal = block.speed_mm_per_s * (block.jog || block.rapid ? 1 : overrides_[0] / 100.0);
    const double limit = stops ? 0 : std::min(nominal, std::sqrt(2 * a * stopping_distance_mm()) + 0.5 * a * dt_s);
    speed_mm_per_s_ = speed_mm_per_s_ < limit ? std::min(limit, speed_mm_per_s_ + a * left_s)
                                              : std::max(limit, speed_mm_per_s_ - 2 * a * left_s);
    if (stops && speed_mm_per_s_ <= 0) {
      if (!jog_cancelled_) return hold_is_complete();
      planner_.clear();
      planned_mm_ = parsed_mm_ = counted_mm_;
      return come_to_rest();
    }
    // stepper.c st_prep_buffer: power from the block, with the speed where M4 is on in laser mode.
    follows_speed_ = laser_mode() && block.spindle == 4;
    const double full = block.spindle == 5 ? 0 : output_of(block.power);
    reported_power_ = output_power_ =
        follows_speed_ ? full * std::min(1.0, speed_mm_per_s_ / block.speed_mm_per_s) : full;
    if (block.spindle != 5) output_spindle_ = block.spindle;
    beam_ = output_power_ > 0;
    const double remaining = distance(counted_mm_, block.to_mm), travel = speed_mm_per_s_ * left_s;
    const Point before = counted_mm_;
    double took_s = left_s;
    if (travel >= remaining) {
      counted_mm_ = block.to_mm;
      took_s = speed_mm_per_s_ > 0 ? std::min(left_s, remaining / speed_mm_per_s_) : left_s;
    } else {
      for (std::size_t k = 0; k < 3; ++k) counted_mm_[k] += (block.to_mm[k] - counted_mm_[k]) * travel / remaining;
    }
    left_s -= took_s;
    if (beam_) record_beam(before, took_s, full, block.jog, block.serial);
    if (counted_mm_ == block.to_mm) planner_.pop_front();
  }
}

void VirtualGrbl::record_beam(const Point& from_mm, double seconds, double power, bool jog, long serial) {
  Point from = from_mm;
  for (std::size_t k = 0; k < 3; ++k) from[k] += shift_mm_[k];
  const Point to = position_mm();
  if (!burns_.empty() && burns_.back().to_mm == from && burns_.back().power == power && burn_serial_ == serial) {
    burns_.back().to_mm = to;
    burns_.back().seconds += seconds;
  } else {
    burns_.push_back({from, to, power, seconds, jog});
  }
  burn_serial_ = serial;
}

bool VirtualGrbl::add_block(const Block& block) {
  if (block.to_mm == planned_mm_) return false;
  planner_.push_back(block);
  planner_.back().serial = ++last_serial_;
  planned_mm_ = block.to_mm;
  if (state_ == "Idle") state_ = block.jog ? "Jog" : "Run";
  return true;
}

}  // namespace formwright
