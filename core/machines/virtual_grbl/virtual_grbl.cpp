// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/virtual_grbl/virtual_grbl.h"

#include <algorithm>

namespace formwright {
namespace {

constexpr double step_s = 1e-3;
constexpr double forgets_reset_s = 0.02;

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
               {10, 3},
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
  for (const int system : {28, 30, 54, 55, 56, 57, 58, 59}) systems_[system] = {0, 0, 0};
  if (options_.grblhal) become_grblhal();
}

VirtualGrbl::Point VirtualGrbl::position_mm() const {
  return {counted_mm_[0] + shift_mm_[0], counted_mm_[1] + shift_mm_[1], counted_mm_[2] + shift_mm_[2]};
}

VirtualGrbl::Point VirtualGrbl::origin_mm(int system) const {
  Point place = systems_.at(system);
  for (std::size_t k = 0; k < 3; ++k) place[k] += shift_mm_[k];
  return place;
}

void VirtualGrbl::open(double now_s) {
  time_s_ = now_s;
  if (state_ == "Off" || options_.resets_on_open) boot(now_s);
}

void VirtualGrbl::boot(double now_s) {
  state_ = "Boot";
  homed_ = false;
  boots_at_s_ = now_s + options_.boot_s;
  rx_.clear();
  planner_.clear();
  steps_.clear();
  startup_left_.clear();
  ++epoch_;
  in_line_ = false;
  output_.clear();
  // Powered up, it counts from wherever it stands (main.c clears sys_position).
  shift_mm_ = position_mm();
  counted_mm_ = planned_mm_ = {0, 0, 0};
  set_spindle(5, 0);
  beam_ = dead_ = jog_cancelled_ = false;
  speed_mm_per_s_ = 0;
}

void VirtualGrbl::reset() {
  // grblHAL protocol.c protocol_exec_rt_system: a reset that comes before it waits for one is forgotten.
  if (options_.grblhal && dead_ && time_s_ - alarm_at_s_ < forgets_reset_s) return;
  const bool moving =
      state_ == "Run" || state_ == "Jog" || state_ == "Home" || (state_ == "Hold" && speed_mm_per_s_ > 0);
  const bool homing = state_ == "Home", was_alarm = state_ == "Alarm";
  rx_.clear();
  planner_.clear();
  steps_.clear();
  startup_left_.clear();
  ++epoch_;
  in_line_ = false;
  modes_ = {};  // G92 and the tool's length with them (gcode.c gc_init)
  planned_mm_ = parsed_mm_ = counted_mm_;
  set_spindle(5, 0);
  beam_ = dead_ = jog_cancelled_ = false;
  speed_mm_per_s_ = 0;
  dwell_left_s_ = homes_at_s_ = -1;
  last_error_ = offset_reports_ = override_reports_ = 0;
  overrides_ = {100, 100, 100};
  homed_ = homed_ && !moving;
  if (moving) output_ += homing ? "ALARM:6\r\n" : "ALARM:3\r\n";
  keeps_printable_ = false;
  output_ += options_.grblhal ? "\r\nGrblHAL 1.1f ['$' or '$HELP' for help]\r\n" : "\r\nGrbl 1.1h ['$' for help]\r\n";
  if (homing_required()) {
    state_ = "Alarm", alarm_ = 11;
    output_ += "ALARM:11\r\n[MSG:Homing cycle required]\r\n";
  } else if (moving || was_alarm || locked_) {
    state_ = "Alarm";
    output_ += "[MSG:'$H'|'$X' to unlock]\r\n";
  } else {
    state_ = "Idle";
    run_startup_lines();
  }
}

void VirtualGrbl::alarm(int code) {
  output_ += "ALARM:" + std::to_string(code) + "\r\n";
  state_ = "Alarm";
  alarm_ = code;
  alarm_at_s_ = time_s_;
  homed_ = homed_ && code != 1;
  set_spindle(5, 0);
  beam_ = false;
  speed_mm_per_s_ = 0;
  planner_.clear();
  steps_.clear();
  startup_left_.clear();
  ++epoch_;
  in_line_ = false;
  locked_ = true;
  dwell_left_s_ = -1;
  if (code == 1 || code == 2) {
    dead_ = true;  // protocol.c protocol_exec_rt_system: nothing but a reset ends this
    output_ += "[MSG:Reset to continue]\r\n";
  }
}

void VirtualGrbl::receive(std::string_view bytes, double now_s) {
  advance(now_s);
  for (const char c : bytes) {
    auto byte = static_cast<unsigned char>(c);
    if (state_ == "Off" || state_ == "Boot") continue;  // the boot loader swallows it
    if (options_.grblhal) byte = heard_as(byte);
    const bool printable = byte == '?' || byte == '!' || byte == '~';
    const bool text = keeps_printable_ && printable && byte == static_cast<unsigned char>(c);
    if (!text && (printable || byte == 0x18 || byte >= 0x80)) real_time(byte);
    else if (now_s < deaf_until_s_) ++deaf_;
    else if (rx_.size() >= static_cast<std::size_t>(options_.rx_bytes)) ++overrun_;
    else rx_ += c;
  }
}

void VirtualGrbl::real_time(unsigned char c) {
  if (c == 0x18) return reset();
  if (options_.grblhal && c == '?') return report();  // locked and homing, too
  if (dead_ || state_ == "Home") return;
  if (state_ == "Sleep" && c != '?') return;
  const auto change = [&](int& percent, int to, int high) {
    percent = std::clamp(to, 10, high);
    override_reports_ = 0;
    // protocol.c: at rest the spindle is set anew, whatever the motion mode.
    if (&percent == &overrides_[2] && state_ == "Idle") set_spindle(modes_.spindle, modes_.power);
  };
  int &feed = overrides_[0], &power = overrides_[2];
  switch (c) {
    case '?': return report();
    case '!':
      if (state_ == "Jog") jog_cancelled_ = true;
      else if (state_ == "Run") state_ = "Hold";
      else if (state_ == "Idle") state_ = "Hold", hold_is_complete();
      return;
    case '~':
      if (state_ == "Tool") state_ = "Idle";
      if (state_ == "Hold" && speed_mm_per_s_ == 0) state_ = planner_.empty() ? "Idle" : "Run";
      return;
    case 0x85:
      if (options_.grblhal) cancel_unread_lines();
      if (state_ == "Jog") jog_cancelled_ = true;
      return;
    case 0x90: return change(feed, 100, 200);
    case 0x91: return change(feed, feed + 10, 200);
    case 0x92: return change(feed, feed - 10, 200);
    case 0x93: return change(feed, feed + 1, 200);
    case 0x94: return change(feed, feed - 1, 200);
    case 0x99: return change(power, 100, 200);
    case 0x9a: return change(power, power + 10, 200);
    case 0x9b: return change(power, power - 10, 200);
    case 0x9c: return change(power, power + 1, 200);
    case 0x9d: return change(power, power - 1, 200);
    default: return;
  }
}

void VirtualGrbl::advance(double now_s) {
  while (time_s_ + step_s <= now_s) {
    time_s_ += step_s;
    step(step_s);
  }
}

void VirtualGrbl::step(double dt_s) {
  if (state_ == "Off" || state_ == "Sleep" || dead_) return;
  if (state_ == "Boot") {
    if (time_s_ < boots_at_s_) return;
    state_ = "Idle";
    locked_ = settings_[22] != 0;
    if (options_.grblhal && (static_cast<int>(settings_[22]) & 4) == 0) locked_ = false;
    alarm_ = 0;
    reset();
    return;
  }
  if (state_ == "Home") {
    if (time_s_ < homes_at_s_) return;
    const double off = settings_[27];
    counted_mm_ = options_.origin_low ? Point{0, 0, 0} : Point{-off, -off, -off};
    planned_mm_ = parsed_mm_ = counted_mm_;
    shift_mm_ = {0, 0, 0};
    locked_ = false;
    homed_ = true;
    state_ = "Idle";
  }
  move(dt_s);
  if (dwell_left_s_ > 0 && state_ != "Hold") dwell_left_s_ -= dt_s;
  run_steps();
  // A hold keeps the main loop, so that no line is read (protocol.c protocol_exec_rt_suspend).
  for (int lines = 0; lines < 4 && !in_line_ && startup_left_.empty() && !dead_; ++lines) {
    if (state_ == "Hold" || state_ == "Home" || state_ == "Sleep" || state_ == "Tool" ||
        rx_.find('\n') == std::string::npos)
      break;
    read_line();
    run_steps();
  }
}

}  // namespace formwright
