// SPDX-License-Identifier: GPL-3.0-or-later
// What the virtual GRBL says of itself: grbl 1.1h report.c, doc/markdown/interface.md.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "machines/virtual_grbl/virtual_grbl.h"

namespace formwright {
namespace {

// report.h: how many reports lie between two that tell offsets or overrides, at work and at rest.
constexpr int offsets_busy = 30, offsets_idle = 10, overrides_busy = 20, overrides_idle = 10;

template <class... Values>
std::string print(const char* format, Values... values) {
  char text[200];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

}  // namespace

/// Three numbers, in inches with $13.
std::string VirtualGrbl::place(const Point& mm) const {
  const bool inches = settings_.at(13) != 0;
  const double unit = inches ? 25.4 : 1;
  return print(inches ? "%.4f,%.4f,%.4f" : "%.3f,%.3f,%.3f", mm[0] / unit, mm[1] / unit, mm[2] / unit);
}

void VirtualGrbl::report() {
  const int mask = static_cast<int>(settings_[10]);
  const bool busy = state_ == "Run" || state_ == "Jog" || state_ == "Hold";
  const Point offset = offset_mm(modes_);
  Point shown = counted_mm_;
  if (!(mask & 1))
    for (std::size_t k = 0; k < 3; ++k) shown[k] -= offset[k];
  std::string state = state_;
  if (options_.grblhal && state_ == "Alarm" && alarm_ > 0) state += ":" + std::to_string(alarm_);
  if (state_ == "Hold") state += speed_mm_per_s_ > 0 ? ":1" : ":0";
  output_ += "<" + state + (mask & 1 ? "|MPos:" : "|WPos:") + place(shown);
  const auto blocks = static_cast<std::size_t>(options_.planner_blocks);
  if (mask & 2)
    output_ += print("|Bf:%d,%d", static_cast<int>(blocks - std::min(planner_.size(), blocks)),
                     options_.rx_bytes - static_cast<int>(rx_.size()));
  output_ += print("|FS:%.0f,%.0f", 60 * speed_mm_per_s_ / (settings_[13] != 0 ? 25.4 : 1), reported_power_);
  if (offset_reports_ > 0) {
    --offset_reports_;
  } else {
    offset_reports_ = (busy ? offsets_busy : offsets_idle) - 1;
    override_reports_ = std::max(override_reports_, 1);  // the next report
    output_ += "|WCO:" + place(offset);
  }
  if (override_reports_ > 0) {
    --override_reports_;
  } else {
    override_reports_ = (busy ? overrides_busy : overrides_idle) - 1;
    output_ += print("|Ov:%d,%d,%d", overrides_[0], overrides_[1], overrides_[2]);
    if (output_power_ > 0) output_ += output_spindle_ == 4 ? "|A:C" : "|A:S";
  }
  output_ += ">\r\n";
}

void VirtualGrbl::report_settings() {
  for (const auto& [number, value] : settings_)
    output_ += print(number < 100 && value == std::floor(value) ? "$%d=%.0f\r\n" : "$%d=%.3f\r\n", number, value);
}

void VirtualGrbl::report_modes() {
  output_ += print("[GC:G%d G%d G%d G%d G%d G%d M%d M9 T0 F%.0f S%.0f]\r\n", modes_.motion, modes_.system, modes_.plane,
                   modes_.inches ? 20 : 21, modes_.relative ? 91 : 90, modes_.inverse_time ? 93 : 94, modes_.spindle,
                   modes_.feed_mm_per_min / (settings_[13] != 0 ? 25.4 : 1), modes_.power);
}

void VirtualGrbl::report_offsets() {
  for (const int system : {54, 55, 56, 57, 58, 59, 28, 30})
    output_ += "[G" + std::to_string(system) + ":" + place(systems_[system]) + "]\r\n";
  output_ += "[G92:" + place(modes_.g92_mm) + "]\r\n";
  output_ += print("[TLO:%.3f]\r\n", modes_.tool_mm / (settings_[13] != 0 ? 25.4 : 1));
  output_ += "[PRB:" + place({0, 0, 0}) + ":0]\r\n";
}

}  // namespace formwright
