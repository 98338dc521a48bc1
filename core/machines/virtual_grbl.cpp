// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/virtual_grbl.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace formwright {
namespace {

constexpr std::size_t rx_bytes = 128;
constexpr double step_s = 1e-3;

double distance(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

}  // namespace

VirtualGrbl::VirtualGrbl(const VirtualGrblOptions& options) : options_(options) {
  const double rapid = 60 * options.rapid_mm_per_s;
  settings_ = {{0, 10},
               {1, 25},
               {2, 0},
               {3, 0},
               {4, 0},
               {5, 0},
               {6, 0},
               {10, 1},
               {11, 0.01},
               {12, 0.002},
               {13, 0},
               {20, options.soft_limits ? 1 : 0},
               {21, 0},
               {22, options.homes ? 1 : 0},
               {23, options.origin_low ? 3 : 0},
               {24, 100},
               {25, 1500},
               {26, 250},
               {27, 1},
               {30, 1000},
               {31, 0},
               {32, options.laser_mode ? 1 : 0},
               {100, 80},
               {101, 80},
               {102, 400},
               {110, rapid},
               {111, rapid},
               {112, 600},
               {120, options.acceleration_mm_per_s2},
               {121, options.acceleration_mm_per_s2},
               {122, 50},
               {130, options.travel_x_mm},
               {131, options.travel_y_mm},
               {132, options.travel_z_mm}};
}

void VirtualGrbl::open(double now_s) {
  time_s_ = now_s;
  if (state_ == "Off" || options_.resets_on_open) boot(now_s);
}

void VirtualGrbl::boot(double now_s) {
  state_ = "Boot";
  boots_at_s_ = now_s + options_.boot_s;
  rx_.clear();
  planner_.clear();
  output_.clear();
  beam_ = dead_ = holding_ = program_pause_ = false;
  speed_mm_per_s_ = 0;
}

void VirtualGrbl::reset() {
  const bool moving = state_ == "Run" || state_ == "Jog" || state_ == "Home" || (holding_ && speed_mm_per_s_ > 0);
  const bool homing = state_ == "Home";
  rx_.clear();
  line_.clear();
  planner_.clear();
  const std::array<double, 3> offset = modes_.offset_mm;
  modes_ = {};
  modes_.offset_mm = offset;
  planned_mm_ = position_mm_;
  beam_ = holding_ = dead_ = program_pause_ = jog_cancelled_ = false;
  speed_mm_per_s_ = 0;
  dwell_until_s_ = homes_at_s_ = -1;
  overrides_ = {100, 100, 100};
  const bool was_alarm = state_ == "Alarm";
  if (moving) output_ += homing ? "ALARM:6\r\n" : "ALARM:3\r\n";
  output_ += "\r\nGrbl 1.1h ['$' for help]\r\n";
  if (moving || was_alarm || locked_) {
    state_ = "Alarm";
    output_ += "[MSG:'$H'|'$X' to unlock]\r\n";
  } else {
    state_ = "Idle";
  }
}

void VirtualGrbl::alarm(int code) {
  output_ += "ALARM:" + std::to_string(code) + "\r\n";
  state_ = "Alarm";
  beam_ = false;
  speed_mm_per_s_ = 0;
  planner_.clear();
  locked_ = true;
  if (code == 1 || code == 2) {
    dead_ = true;
    output_ += "[MSG:Reset to continue]\r\n";
  }
}

void VirtualGrbl::receive(std::string_view bytes, double now_s) {
  advance(now_s);
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    if (state_ == "Off" || state_ == "Boot") continue;  // the boot loader swallows it
    if (byte == '?' || byte == '!' || byte == '~' || byte == 0x18 || byte >= 0x80) real_time(byte);
    else if (now_s < deaf_until_s_) ++deaf_;
    else if (rx_.size() >= rx_bytes) ++overrun_;
    else rx_ += c;
  }
}

void VirtualGrbl::real_time(unsigned char c) {
  if (c == 0x18) return reset();
  if (dead_ || state_ == "Home") return;
  const auto change = [&](int& percent, int by, int high) { percent = std::clamp(percent + by, 10, high); };
  switch (c) {
    case '?': return report();
    case '!':
      if (state_ == "Jog") jog_cancelled_ = true;
      else if (state_ == "Run") holding_ = true, state_ = "Hold";
      return;
    case '~':
      if (state_ == "Hold" && speed_mm_per_s_ == 0) {
        holding_ = program_pause_ = false;
        state_ = planner_.empty() ? "Idle" : "Run";
      }
      return;
    case 0x85:
      if (state_ == "Jog") jog_cancelled_ = true;
      return;
    case 0x90: overrides_[0] = 100; return;
    case 0x91: return change(overrides_[0], 10, 200);
    case 0x92: return change(overrides_[0], -10, 200);
    case 0x93: return change(overrides_[0], 1, 200);
    case 0x94: return change(overrides_[0], -1, 200);
    case 0x99: overrides_[2] = 100; return;
    case 0x9a: return change(overrides_[2], 10, 200);
    case 0x9b: return change(overrides_[2], -10, 200);
    case 0x9c: return change(overrides_[2], 1, 200);
    case 0x9d: return change(overrides_[2], -1, 200);
    default: return;
  }
}

void VirtualGrbl::report() {
  char text[200];
  std::string state = state_;
  if (state_ == "Hold") state += speed_mm_per_s_ > 0 ? ":1" : ":0";
  std::snprintf(text, sizeof text, "<%s|MPos:%.3f,%.3f,%.3f|Bf:%d,%d|FS:%.0f,%.0f", state.c_str(), position_mm_[0],
                position_mm_[1], position_mm_[2], static_cast<int>(15 - std::min<std::size_t>(planner_.size(), 15)),
                static_cast<int>(rx_bytes - rx_.size()), 60 * speed_mm_per_s_,
                beam_ ? planner_.empty() ? modes_.power : planner_.front().power : 0.0);
  output_ += text;
  if (reports_ % 10 == 0) {
    std::snprintf(text, sizeof text, "|WCO:%.3f,%.3f,%.3f", modes_.offset_mm[0], modes_.offset_mm[1],
                  modes_.offset_mm[2]);
    output_ += text;
  } else if (reports_ % 10 == 1) {
    std::snprintf(text, sizeof text, "|Ov:%d,%d,%d", overrides_[0], overrides_[1], overrides_[2]);
    output_ += text;
  }
  ++reports_;
  output_ += ">\r\n";
}

void VirtualGrbl::advance(double now_s) {
  while (time_s_ + step_s <= now_s) {
    time_s_ += step_s;
    step(step_s);
  }
}

void VirtualGrbl::step(double dt_s) {
  if (state_ == "Off" || dead_) return;
  if (state_ == "Boot") {
    if (time_s_ < boots_at_s_) return;
    state_ = "Idle";
    locked_ = settings_[22] != 0;
    reset();
    return;
  }
  if (state_ == "Home") {
    if (time_s_ < homes_at_s_) return;
    position_mm_ = planned_mm_ = options_.origin_low
                                     ? std::array<double, 3>{0, 0, 0}
                                     : std::array<double, 3>{-settings_[27], -settings_[27], -settings_[27]};
    locked_ = false;
    state_ = "Idle";
    answer(0);
    return;
  }
  move(dt_s);
  if (dwell_until_s_ >= 0 && planner_.empty() && state_ != "Hold") {
    if (time_s_ < dwell_until_s_) return;
    dwell_until_s_ = -1;
    answer(0);
  }
  for (int lines = 0; lines < 4 && dwell_until_s_ < 0 && state_ != "Home" && !program_pause_ && !dead_; ++lines) {
    if (planner_.size() >= 15 || rx_.find('\n') == std::string::npos) break;
    read_line();
  }
  if (program_pause_ && planner_.empty() && state_ == "Idle") state_ = "Hold";
}

double VirtualGrbl::stopping_distance_mm() const {
  // To the end of what is planned, or to the first sharp corner.
  double sum = distance(position_mm_, planner_.front().to_mm);
  for (std::size_t i = 0; i + 1 < planner_.size(); ++i) {
    const auto& a = i == 0 ? position_mm_ : planner_[i - 1].to_mm;
    const auto &b = planner_[i].to_mm, &c = planner_[i + 1].to_mm;
    const double ab = distance(a, b), bc = distance(b, c);
    double dot = 0;
    for (std::size_t k = 0; k < 3; ++k) dot += (b[k] - a[k]) * (c[k] - b[k]);
    if (ab > 0 && bc > 0 && dot < 0.9 * ab * bc) break;
    sum += bc;
  }
  return sum;
}

void VirtualGrbl::move(double dt_s) {
  const double a = options_.acceleration_mm_per_s2;
  const bool stops = holding_ || jog_cancelled_;
  if (planner_.empty() || (state_ != "Run" && state_ != "Jog" && !(state_ == "Hold" && speed_mm_per_s_ > 0))) {
    if (state_ == "Run" || state_ == "Jog") {
      if (state_ == "Run" && rx_.empty()) ++ran_dry_;
      state_ = "Idle";
    }
    speed_mm_per_s_ = 0;
    jog_cancelled_ = false;
    // In laser mode the beam is on at rest only with M3 and a cutting motion (G1 to G3).
    beam_ = state_ == "Idle" && modes_.spindle == 3 && modes_.power > 0 && (settings_[32] == 0 || modes_.motion != 0);
    return;
  }
  double left_s = dt_s;
  while (left_s > 1e-12 && !planner_.empty()) {
    const Block& block = planner_.front();
    const double nominal = block.speed_mm_per_s * (block.burns || !block.jog ? overrides_[0] / 100.0 : 1);
    const double limit = stops ? 0 : std::min(nominal, std::sqrt(2 * a * stopping_distance_mm()) + 0.5 * a * dt_s);
    speed_mm_per_s_ = speed_mm_per_s_ < limit ? std::min(limit, speed_mm_per_s_ + a * left_s)
                                              : std::max(limit, speed_mm_per_s_ - 2 * a * left_s);
    if (stops && speed_mm_per_s_ <= 0) {
      speed_mm_per_s_ = 0;
      beam_ = false;
      if (jog_cancelled_) {
        planner_.clear();
        planned_mm_ = position_mm_;
        jog_cancelled_ = false;
        state_ = "Idle";
      }
      return;
    }
    const double remaining = distance(position_mm_, block.to_mm), way = speed_mm_per_s_ * left_s;
    beam_ = block.burns && block.power > 0;  // a hold turns it off once at rest
    const std::array<double, 3> before = position_mm_;
    if (way >= remaining) {
      position_mm_ = block.to_mm;
      left_s -= speed_mm_per_s_ > 0 ? remaining / speed_mm_per_s_ : left_s;
    } else {
      for (std::size_t k = 0; k < 3; ++k) position_mm_[k] += (block.to_mm[k] - position_mm_[k]) * way / remaining;
      left_s = 0;
    }
    if (beam_ && distance(before, position_mm_) > 0) {
      if (!burns_.empty() && burns_.back().to_mm == before && burns_.back().power == block.power &&
          burn_from_mm_ == block.to_mm)
        burns_.back().to_mm = position_mm_;
      else burns_.push_back({before, position_mm_, block.power});
      burn_from_mm_ = block.to_mm;
    }
    if (position_mm_ == block.to_mm) planner_.pop_front();
  }
}

}  // namespace formwright
