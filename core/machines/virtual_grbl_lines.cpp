// SPDX-License-Identifier: GPL-3.0-or-later
// What the virtual GRBL does with a line.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <numbers>
#include <optional>

#include "machines/virtual_grbl.h"

namespace formwright {

void VirtualGrbl::answer(int error) { output_ += error == 0 ? "ok\r\n" : "error:" + std::to_string(error) + "\r\n"; }

void VirtualGrbl::read_line() {
  const std::size_t end = rx_.find('\n');
  std::string line;
  for (const char c : rx_.substr(0, end))
    if (c > ' ') line += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  rx_.erase(0, end + 1);
  lines_.push_back(line);
  if (line.size() > 79) return answer(11);
  if (refuse_next_ != 0 && !line.empty()) return answer(std::exchange(refuse_next_, 0));
  if (const int error = line.empty() ? 0 : act(line); error >= 0) answer(error);
}

int VirtualGrbl::act(const std::string& line) {
  if (line[0] != '$') return state_ == "Alarm" || state_ == "Jog" ? 9 : act_on_gcode(line, false);
  if (line.starts_with("$J="))
    return state_ == "Idle" || state_ == "Jog" ? act_on_gcode(line.substr(3), true) : state_ == "Alarm" ? 9 : 8;
  if (state_ != "Idle" && state_ != "Alarm") return 8;
  return act_on_setting(line);
}

int VirtualGrbl::act_on_setting(const std::string& line) {
  char text[96];
  if (line == "$$") {
    for (const auto& [number, value] : settings_) {
      std::snprintf(text, sizeof text, number < 100 && value == std::floor(value) ? "$%d=%.0f\r\n" : "$%d=%.3f\r\n",
                    number, value);
      output_ += text;
    }
    return 0;
  }
  if (line == "$I") {
    output_ +=
        std::string("[VER:1.1h.20190825:Practice]\r\n[OPT:V") + (options_.origin_low ? "Z" : "") + ",15,128]\r\n";
    return 0;
  }
  if (line == "$G") {
    std::snprintf(text, sizeof text, "[GC:G%d G54 G17 G%d G%d G94 M%d M9 T0 F%.0f S%.0f]\r\n", modes_.motion,
                  modes_.inches ? 20 : 21, modes_.relative ? 91 : 90, modes_.spindle, modes_.feed_mm_per_min,
                  modes_.power);
    output_ += text;
    return 0;
  }
  if (line == "$X") {
    if (state_ == "Alarm") output_ += "[MSG:Caution: Unlocked]\r\n";
    locked_ = false;
    state_ = "Idle";
    return 0;
  }
  if (line == "$H") {
    if (settings_[22] == 0) return 5;
    state_ = "Home";
    homes_at_s_ = time_s_ + options_.homing_s;
    return -1;
  }
  char* rest = nullptr;
  const long number = std::strtol(line.c_str() + 1, &rest, 10);
  if (rest == line.c_str() + 1 || *rest != '=') return 3;
  const double value = std::strtod(rest + 1, nullptr);
  if (!settings_.contains(static_cast<int>(number))) return 3;
  if (value < 0) return 4;
  settings_[static_cast<int>(number)] = value;
  return write_eeprom();
}

int VirtualGrbl::write_eeprom() {
  // Nothing is heard meanwhile; the answer comes when it is written.
  deaf_until_s_ = dwell_until_s_ = time_s_ + options_.eeprom_s;
  return -1;
}

int VirtualGrbl::act_on_gcode(const std::string& line, bool jog) {
  Modes next = modes_;
  std::array<std::optional<double>, 3> target;
  double i = 0, j = 0, p = 0;
  bool arc_centre = false, dwell = false, set_offset = false, offset_absolute = false, pause = false, end = false,
       machine = false;
  int groups = 0;
  for (const char* at = line.c_str(); *at != '\0';) {
    const char letter = *at++;
    if (letter < 'A' || letter > 'Z') return 1;
    // By hand where a number ends: strtod would read "0X5" as hexadecimal.
    const std::string digits(at, std::strspn(at, "+-.0123456789"));
    char* rest = nullptr;
    const double value = std::strtod(digits.c_str(), &rest);
    if (digits.empty() || *rest != '\0' || !std::isfinite(value)) return 2;
    at += digits.size();
    const int whole = static_cast<int>(std::lround(value));
    const double mm = next.inches ? 25.4 * value : value;
    switch (letter) {
      case 'G':
        if (jog && whole != 20 && whole != 21 && whole != 90 && whole != 91 && whole != 53) return 16;
        if (value != whole && whole != 38 && whole != 28 && whole != 92) return 20;
        if (whole >= 0 && whole <= 3) {
          if (groups & 1) return 21;
          groups |= 1;
          next.motion = whole;
        } else if (whole == 4) dwell = true;
        else if (whole == 10) set_offset = true;
        else if (whole == 20 || whole == 21) next.inches = whole == 20;
        else if (whole == 90 || whole == 91) next.relative = whole == 91;
        else if (whole == 53) machine = true;
        else if (whole != 17 && whole != 54 && whole != 94 && whole != 40 && whole != 49 && whole != 80) return 20;
        break;
      case 'M':
        if (whole == 3 || whole == 4 || whole == 5) next.spindle = whole;
        else if (whole == 0) pause = true;
        else if (whole == 2 || whole == 30) end = true;
        else if (whole != 7 && whole != 8 && whole != 9) return 20;
        break;
      case 'X':
      case 'Y':
      case 'Z': target[static_cast<std::size_t>(letter - 'X')] = mm; break;
      case 'I': i = mm, arc_centre = true; break;
      case 'J': j = mm, arc_centre = true; break;
      case 'F':
        if (value < 0) return 4;
        next.feed_mm_per_min = mm;
        break;
      case 'S':
        if (value < 0) return 4;
        next.power = value;
        break;
      case 'P': p = value; break;
      case 'L': offset_absolute = whole == 2; break;
      case 'N':
      case 'T': break;
      default: return 20;
    }
  }
  const bool moves = target[0] || target[1] || target[2];
  std::array<double, 3> to = planned_mm_;
  for (std::size_t k = 0; k < 3; ++k)
    if (target[k]) to[k] = next.relative ? planned_mm_[k] + *target[k] : *target[k] + (machine ? 0 : next.offset_mm[k]);
  if (set_offset) {
    for (std::size_t k = 0; k < 3; ++k)
      if (target[k]) next.offset_mm[k] = offset_absolute ? *target[k] : planned_mm_[k] - *target[k];
    modes_ = next;
    reports_ = 0;
    return write_eeprom();
  }
  if (jog && (!moves || next.feed_mm_per_min <= 0)) return moves ? 22 : 26;
  const bool cuts = next.motion > 0;
  if (moves && !jog && cuts && next.feed_mm_per_min <= 0) return 22;
  if (moves && !jog && next.motion > 1 && !arc_centre) return 35;
  if (moves && settings_[20] != 0) {
    const double travel[] = {settings_[130], settings_[131], settings_[132]};
    for (std::size_t k = 0; k < 3; ++k)
      if (const double low = options_.origin_low && k < 2 ? 0 : -travel[k]; to[k] < low || to[k] > low + travel[k]) {
        if (jog) return 15;
        alarm(2);
        return -1;
      }
  }
  Block block;
  block.to_mm = to;
  block.jog = jog;
  block.speed_mm_per_s = (jog || cuts ? next.feed_mm_per_min : settings_[110]) / 60;
  block.speed_mm_per_s = std::min(block.speed_mm_per_s, settings_[110] / 60);
  block.burns = !jog && next.spindle != 5 && (cuts || settings_[32] == 0);
  block.power = block.burns ? next.power : 0;
  block.follows_speed = next.spindle == 4;
  if (jog) {
    if (const int error = add_block(block)) return error;
    if (state_ == "Idle" && !planner_.empty()) state_ = "Jog";
    return 0;  // a jog leaves no modes behind
  }
  const std::array<double, 3> offset = modes_.offset_mm;
  modes_ = next;
  modes_.offset_mm = offset;
  if (moves) {
    if (const int error = next.motion > 1 ? add_arc(to, i, j, block) : add_block(block)) return error;
    if (state_ == "Idle" && !planner_.empty()) state_ = "Run";
  }
  if (end) modes_.spindle = 5, modes_.motion = 1, modes_.relative = false, output_ += "[MSG:Pgm End]\r\n";
  if (pause) program_pause_ = true;
  if (dwell) {
    dwell_until_s_ = time_s_ + p;
    return -1;
  }
  return 0;
}

int VirtualGrbl::add_block(const Block& block) {
  if (block.to_mm == planned_mm_) return 0;
  planner_.push_back(block);
  planned_mm_ = block.to_mm;
  return 0;
}

int VirtualGrbl::add_arc(const std::array<double, 3>& to_mm, double i_mm, double j_mm, const Block& like) {
  const double cx = planned_mm_[0] + i_mm, cy = planned_mm_[1] + j_mm, radius = std::hypot(i_mm, j_mm);
  const double end_radius = std::hypot(to_mm[0] - cx, to_mm[1] - cy);
  if (std::abs(end_radius - radius) > std::max(0.005, 0.001 * radius)) return 33;
  const bool clockwise = modes_.motion == 2;
  const double start = std::atan2(-j_mm, -i_mm);
  double sweep = std::atan2(to_mm[1] - cy, to_mm[0] - cx) - start;
  if (clockwise)
    while (sweep >= -1e-9) sweep -= 2 * std::numbers::pi;
  else
    while (sweep <= 1e-9) sweep += 2 * std::numbers::pi;
  const int segments =
      std::max(1, static_cast<int>(std::ceil(std::abs(sweep) /
                                             (2 * std::acos(1 - std::min(1.0, 0.002 / std::max(radius, 0.002)))))));
  Block block = like;
  for (int s = 1; s <= segments; ++s) {
    const double angle = start + sweep * s / segments, t = static_cast<double>(s) / segments;
    block.to_mm = s == segments ? to_mm
                                : std::array<double, 3>{cx + radius * std::cos(angle), cy + radius * std::sin(angle),
                                                        planned_mm_[2] + (to_mm[2] - planned_mm_[2]) * t};
    add_block(block);
  }
  return 0;
}

}  // namespace formwright
