// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/marlin/marlin_place.h"

#include <cmath>
#include <cstdlib>

namespace formwright {
namespace {

constexpr std::string_view letters = "XYZ";

/// The axes that a line names; all where it names none.
std::array<bool, 3> axes_of(std::string_view line) {
  std::array<bool, 3> named{};
  bool any = false;
  for (std::size_t axis = 0; axis < 3; ++axis) any |= named[axis] = line.find(letters[axis]) != std::string_view::npos;
  return any ? named : std::array<bool, 3>{true, true, true};
}

bool is_place_command(std::string_view line, std::string_view name) {
  return line.starts_with(name) && (line.size() == name.size() || line[name.size()] == ' ' ||
                                    (line[name.size()] >= 'A' && line[name.size()] <= 'Z'));
}

}  // namespace

void MarlinPlace::sending(std::string_view line) {
  const bool places = line.starts_with("G92");
  if (is_place_command(line, "G28")) {
    homing_ = axes_of(line);
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (homing_[axis]) known_[axis] = false, origin_mm_[axis].reset();
  } else if (places) set_place(line);
  else if (is_place_command(line, "M84") || is_place_command(line, "M18")) {
    // Motors without current may be pushed.
    const std::array<bool, 3> off = axes_of(line);
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (off[axis]) known_[axis] = false, origin_mm_[axis].reset();
  }
  bool rests = line.empty() || line[0] != 'G' || places;
  for (const char* name : {"G4", "G17", "G20", "G21", "G90", "G91"}) rests = rests || is_place_command(line, name);
  fresh_ = fresh_ && rests;
}

void MarlinPlace::set_place(std::string_view line) {
  origin_expected_ = false;
  const std::string text(line.substr(3));
  bool named = false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t at = text.find(letters[axis]);
    if (at == std::string::npos) continue;
    named = true;
    const double value = std::strtod(text.c_str() + at + 1, nullptr);
    if (origin_mm_[axis] && fresh_ && reported_mm_ && std::isfinite(value))
      *origin_mm_[axis] += (*reported_mm_)[axis] - value;
    else origin_mm_[axis].reset();
    if (fresh_ && reported_mm_) (*reported_mm_)[axis] = value;
    if (position_mm_) (*position_mm_)[axis] = value;
    known_[axis] = true;
  }
  if (text.starts_with(".") || (!named && text.find('E') == std::string::npos)) origin_mm_ = {}, fresh_ = false;
}

void MarlinPlace::homed() {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (homing_[axis]) known_[axis] = true, origin_mm_[axis] = 0;  // set_axis_is_at_home() clears the axis' offset
  homing_ = {};
}

void MarlinPlace::reported(const std::array<double, 3>& mm) {
  reported_mm_ = mm;
  fresh_ = true;
  if (!origin_expected_) position_mm_ = mm;
}

void MarlinPlace::expect_origin(std::string_view axes) {
  origin_expected_ = true;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (axes.find(letters[axis]) == std::string_view::npos) continue;
    known_[axis] = true;
    if (position_mm_) (*position_mm_)[axis] = 0;
  }
}

std::optional<MarlinPlace::Limits> MarlinPlace::limits_in(const std::string& line) {
  const std::size_t low = line.find("Min:"), high = line.find("Max:");
  if (low == std::string::npos || high == std::string::npos || high < low) return std::nullopt;
  const auto number = [&](std::size_t axis, std::size_t from, std::size_t to) -> std::optional<double> {
    const std::size_t at = line.find(letters[axis], from);
    if (at >= to) return std::nullopt;
    const char* start = line.c_str() + at + 1;
    if (*start == ':') ++start;
    char* end = nullptr;
    const double value = std::strtod(start, &end);
    return end != start && std::isfinite(value) ? std::optional(value) : std::nullopt;
  };
  Limits limits;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const auto lowest = number(axis, low + 4, high), highest = number(axis, high + 4, line.size());
    if (!lowest || !highest) return std::nullopt;
    limits.low_mm[axis] = *lowest;
    limits.high_mm[axis] = *highest;
  }
  if (limits.high_mm[0] <= limits.low_mm[0] || limits.high_mm[1] <= limits.low_mm[1]) return std::nullopt;
  return limits;
}

}  // namespace formwright
