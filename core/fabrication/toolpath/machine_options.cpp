// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/toolpath/machine_options.h"

#include <algorithm>

#include "base/data/number_list.h"

namespace formwright {

std::vector<BedRectangle> read_no_go(const std::string& text) {
  const auto numbers = read_number_list(text);
  if (!numbers || numbers->size() % 4 != 0)
    throw Error(ErrorCode::invalid_input, "no_go",
                "No-go zones are four numbers each, x0,y0,x1,y1 in mm: write them like 0,0,40,25; 360,0,400,25.");
  std::vector<BedRectangle> zones;
  for (std::size_t i = 0; i < numbers->size(); i += 4) {
    const double* n = numbers->data() + i;
    const BedRectangle zone{std::min(n[0], n[2]), std::min(n[1], n[3]), std::max(n[0], n[2]), std::max(n[1], n[3])};
    if (zone.x0_mm == zone.x1_mm || zone.y0_mm == zone.y1_mm)
      throw Error(
          ErrorCode::invalid_input, "no_go",
          "No-go zone " + std::to_string(i / 4 + 1) + " has no extent: give two opposite corners, x0,y0,x1,y1.");
    zones.push_back(zone);
  }
  return zones;
}

namespace {
/// K40 boards home to the upper left and know nothing else.
BedOrigin origin_of(const MachineOptions& machine) {
  return machine.controller == Controller::k40 ? BedOrigin::upper_left : machine.origin;
}
}  // namespace

Vec2 to_controller(const Vec2& bed_mm, const MachineOptions& machine) {
  switch (origin_of(machine)) {
    case BedOrigin::lower_left: return bed_mm;
    case BedOrigin::upper_left: return {bed_mm.x(), machine.bed_y_mm - bed_mm.y()};
    case BedOrigin::centre: return bed_mm - Vec2(machine.bed_x_mm / 2, machine.bed_y_mm / 2);
  }
  return bed_mm;
}

Vec2 origin_on_bed(const MachineOptions& machine) {
  switch (origin_of(machine)) {
    case BedOrigin::lower_left: return {0, 0};
    case BedOrigin::upper_left: return {0, machine.bed_y_mm};
    case BedOrigin::centre: return {machine.bed_x_mm / 2, machine.bed_y_mm / 2};
  }
  return {0, 0};
}

}  // namespace formwright
