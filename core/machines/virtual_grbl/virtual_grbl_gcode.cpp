// SPDX-License-Identifier: GPL-3.0-or-later
// What the virtual GRBL does with a line of G-code, in the firmware's order (gcode.c gc_execute_line, step 4).
#include <algorithm>
#include <cmath>
#include <numbers>

#include "machines/virtual_grbl/virtual_grbl_words.h"

namespace formwright {
bool VirtualGrbl::leaves_travel(const Point& to_mm) const {
  if (settings_.at(20) == 0) return false;
  for (std::size_t k = 0; k < 3; ++k) {
    const double travel = settings_.at(130 + static_cast<int>(k)), low = options_.origin_low && k < 2 ? 0 : -travel;
    if (to_mm[k] < low || to_mm[k] > low + travel) return true;
  }
  return false;
}

/// jog.c: whatever the spindle does goes on, whatever the motion mode is.
int VirtualGrbl::jog(const Words& words) {
  if (!words.moves()) return 0;
  if (words.power_word) return 36;
  if (!words.feed || *words.feed <= 0) return 22;
  if (leaves_travel(words.target_mm)) return 15;
  Block block{words.target_mm, std::min(*words.feed, settings_[110]) / 60, modes_.power, modes_.spindle, true};
  parsed_mm_ = words.target_mm;
  then_line(block);
  return 0;
}

int VirtualGrbl::act_on_gcode(const std::string& line, bool is_jog) {
  Words words;
  words.modes = modes_;
  words.modes.flow = 0;
  if (is_jog) words.modes.motion = 1;
  if (const int error = read_words(line, is_jog, words)) return error;
  if (is_jog) words.modes.feed_mm_per_min = words.feed.value_or(0);
  if (const int error = find_target(words)) return error;
  if (is_jog) return jog(words);
  Block block;
  then_set_modes(words, block);
  const int special = words.non_modal;
  const bool motion = words.moves() && special != 100 && special != 280 && special != 300 && special != 920 &&
                      !words.tool_word && words.modes.motion != 80;
  int error = 0;
  if (motion) {
    block.to_mm = words.target_mm;
    if (words.modes.motion > 1) error = then_arc(words, block);
    else then_line(block);
    if (error) return error;
  }
  const int flow = words.modes.flow;
  Modes kept = words.modes;
  kept.flow = 0;
  // The parser is ahead of the machine: its modes are known to the next line at once.
  kept.g92_mm = modes_.g92_mm;
  modes_ = kept;
  if (motion) parsed_mm_ = words.target_mm;
  then_non_modal(words, block);
  if (words.tool_change) then_change_tool();
  if (flow != 0) then_end_program(flow);
  return 0;
}

/// Steps 4, 7 and 10: the beam of a laser follows from the motion mode.
void VirtualGrbl::then_set_modes(const Words& words, Block& block) {
  const Modes &before = modes_, &after = words.modes;
  const bool laser = laser_mode(), cuts = after.motion >= 1 && after.motion <= 3;
  const bool dark = laser && !cuts;
  const bool motion = laser && words.moves() && (words.non_modal == 0 || words.non_modal == 530) && !words.tool_word;
  const bool cut_before = before.motion >= 1 && before.motion <= 3;
  const bool forced = laser && !motion && before.spindle == 3 && cut_before != cuts;
  if ((after.power != before.power || forced) && before.spindle != 5 && !motion)
    then_spindle(before.spindle, dark ? 0 : after.power);
  block.power = dark ? 0 : after.power;
  if (after.spindle != before.spindle) then_spindle(after.spindle, block.power);
  block.spindle = after.spindle;
  block.rapid = after.motion == 0;
  block.speed_mm_per_s = std::min(block.rapid ? settings_[110] : after.feed_mm_per_min, settings_[110]) / 60;
  if (words.non_modal == 40 && state_ != "Check") {
    then_wait_for_rest();
    then([this, seconds = *words.seconds] {
      dwell_left_s_ = seconds;
      return true;
    });
    then([this] { return dwell_left_s_ <= 0; });
  }
}

void VirtualGrbl::then_non_modal(const Words& words, const Block& block) {
  const Point from = parsed_mm_;
  const bool changes_offset = words.non_modal == 100 || words.non_modal == 920 || words.non_modal == 921;
  if (changes_offset || words.tool_word) then_wait_for_rest();
  offset_reports_ = changes_offset || words.tool_word ? 0 : offset_reports_;
  switch (words.non_modal) {
    case 100: {
      const int number = static_cast<int>(words.system.value_or(0)), system = number == 0 ? modes_.system : 53 + number;
      Point& kept = systems_[system];
      for (std::size_t k = 0; k < 3; ++k) {
        if (!words.axes[k]) continue;
        kept[k] = *words.mode_of_system == 2
                      ? *words.axes[k]
                      : from[k] - modes_.g92_mm[k] - (k == 2 ? modes_.tool_mm : 0) - *words.axes[k];
      }
      then_write_eeprom();
      break;
    }
    case 280:
    case 300: {
      Block rapid = block;
      rapid.rapid = true, rapid.speed_mm_per_s = settings_[110] / 60;
      Point home = systems_[words.non_modal / 10];
      if (words.moves()) {
        rapid.to_mm = words.target_mm;
        then_line(rapid);
        for (std::size_t k = 0; k < 3; ++k)
          if (!words.axes[k]) home[k] = from[k];
      }
      rapid.to_mm = home;
      then_line(rapid);
      parsed_mm_ = home;
      break;
    }
    case 281:
    case 301:
      systems_[words.non_modal / 10] = from;
      then_write_eeprom();
      break;
    case 920:
      for (std::size_t k = 0; k < 3; ++k)
        if (words.axes[k])
          modes_.g92_mm[k] = from[k] - systems_[modes_.system][k] - (k == 2 ? modes_.tool_mm : 0) - *words.axes[k];
      break;
    case 921: modes_.g92_mm = {0, 0, 0}; break;
    default: break;
  }
  if (words.tool_word && words.axes[2]) modes_.tool_mm = *words.axes[2];
}

/// M0 holds, M2 and M30 end: spindle off, and the parser as it begins.
void VirtualGrbl::then_end_program(int flow) {
  then_wait_for_rest();
  if (flow == 1) {
    then([this] {
      if (state_ != "Check") state_ = "Hold", hold_is_complete();
      return true;
    });
    then_wait_for_rest();
    return;
  }
  modes_.motion = 1;
  modes_.plane = 17;
  modes_.relative = modes_.inverse_time = false;
  modes_.system = 54;
  modes_.spindle = 5;
  then([this] {
    set_spindle(5, 0);
    output_ += "[MSG:Pgm End]\r\n";
    return true;
  });
}

/// motion_control.c mc_line: waits while the planner is full.
void VirtualGrbl::then_line(const Block& block) {
  then([this, block] {
    if (!block.jog && leaves_travel(block.to_mm)) {
      alarm(2);
      return true;
    }
    if (state_ == "Check") return true;
    if (static_cast<int>(planner_.size()) >= options_.planner_blocks || state_ == "Hold") return false;
    // A move to where it is: with M3 in laser mode the beam is set all the same.
    if (!add_block(block) && laser_mode() && block.spindle == 3 && !block.jog) {
      if (!at_rest()) return false;
      set_spindle(3, block.power);
    }
    return true;
  });
}

/// In the plane chosen (G17 to G19), with a centre or a radius.
int VirtualGrbl::then_arc(const Words& words, const Block& like) {
  const std::size_t a = words.modes.plane == 18   ? 2
                        : words.modes.plane == 19 ? 1
                                                  : 0,
                    b = (a + 1) % 3, up = (a + 2) % 3;
  if (!words.axes[a] && !words.axes[b]) return 32;
  const Point from = parsed_mm_, to = words.target_mm;
  const bool clockwise = words.modes.motion == 2;
  double i = words.centre[a].value_or(0), j = words.centre[b].value_or(0);
  if (words.radius_mm) {
    const double dx = to[a] - from[a], dy = to[b] - from[b], chord = std::hypot(dx, dy), r = *words.radius_mm;
    if (from == to) return 33;
    const double squared = 4 * r * r - chord * chord;
    if (squared < 0) return 34;
    double h = std::sqrt(squared) / chord / 2;
    if (clockwise == (r > 0)) h = -h;
    i = dx / 2 - h * dy, j = dy / 2 + h * dx;
  } else if (!words.centre[a] && !words.centre[b]) {
    return 35;
  }
  const double cx = from[a] + i, cy = from[b] + j, radius = std::hypot(i, j);
  if (std::abs(std::hypot(to[a] - cx, to[b] - cy) - radius) > std::max(0.005, 0.001 * radius)) return 33;
  const double start = std::atan2(-j, -i);
  double sweep = std::atan2(to[b] - cy, to[a] - cx) - start;
  while (clockwise && sweep >= -1e-9) sweep -= 2 * std::numbers::pi;
  while (!clockwise && sweep <= 1e-9) sweep += 2 * std::numbers::pi;
  const double tolerance = 0.002;  // $12
  const int segments = std::max(
      1, static_cast<int>(
             std::ceil(std::abs(sweep) / (2 * std::acos(1 - std::min(1.0, tolerance / std::max(radius, tolerance)))))));
  for (int s = 1; s <= segments; ++s) {
    const double angle = start + sweep * s / segments, t = static_cast<double>(s) / segments;
    Block block = like;
    block.to_mm[a] = cx + radius * std::cos(angle);
    block.to_mm[b] = cy + radius * std::sin(angle);
    block.to_mm[up] = from[up] + (to[up] - from[up]) * t;
    if (s == segments) block.to_mm = to;
    then_line(block);
  }
  return 0;
}

}  // namespace formwright
