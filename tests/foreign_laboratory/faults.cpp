// SPDX-License-Identifier: GPL-3.0-or-later
#include "foreign_laboratory/faults.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace formwright::foreign_laboratory {
namespace {

struct Named {
  const char* name;
  double Faults::*value;
};
constexpr Named named[] = {{"colder_right_k", &Faults::colder_right_k},
                           {"colder_back_k", &Faults::colder_back_k},
                           {"colder_corners_k", &Faults::colder_corners_k},
                           {"slip", &Faults::slip},
                           {"anisotropy", &Faults::anisotropy},
                           {"thicker_right", &Faults::thicker_right},
                           {"thicker_back", &Faults::thicker_back},
                           {"contact_w_per_m2_k", &Faults::contact_w_per_m2_k},
                           {"vacuum_lost", &Faults::vacuum_lost},
                           {"clamp_mm2_per_n_s", &Faults::clamp_mm2_per_n_s},
                           {"mould_shift_x_mm", &Faults::mould_shift_x_mm},
                           {"mould_shift_y_mm", &Faults::mould_shift_y_mm},
                           {"mould_rotation_deg", &Faults::mould_rotation_deg},
                           {"mould_lean_right_deg", &Faults::mould_lean_right_deg},
                           {"mould_lean_back_deg", &Faults::mould_lean_back_deg},
                           {"mould_scale", &Faults::mould_scale},
                           {"print_scale", &Faults::print_scale},
                           {"print_stretch_x", &Faults::print_stretch_x},
                           {"print_stretch_y", &Faults::print_stretch_y},
                           {"print_skew", &Faults::print_skew},
                           {"scan_scale", &Faults::scan_scale},
                           {"scan_stretch_x", &Faults::scan_stretch_x},
                           {"scan_turn_x_deg", &Faults::scan_turn_x_deg},
                           {"scan_turn_y_deg", &Faults::scan_turn_y_deg},
                           {"scan_turn_z_deg", &Faults::scan_turn_z_deg},
                           {"scan_bow_mm", &Faults::scan_bow_mm},
                           {"scan_shift_x_mm", &Faults::scan_shift_x_mm},
                           {"scan_shift_y_mm", &Faults::scan_shift_y_mm},
                           {"scan_shift_z_mm", &Faults::scan_shift_z_mm}};

}  // namespace

double uniform(std::mt19937_64& random, double low, double high) {
  constexpr double per_integer = 1.0 / 9007199254740992.0;  // 2^-53
  return low + (high - low) * (static_cast<double>(random() >> 11) * per_integer);
}

// By the transform of Box and Muller.
double normal(std::mt19937_64& random) {
  const double radius = std::sqrt(-2 * std::log(1 - uniform(random, 0, 1)));
  return radius * std::cos(uniform(random, 0, 2 * std::numbers::pi));
}

bool acts_on_measurement(std::string_view cause) { return cause.starts_with("print_") || cause.starts_with("scan_"); }

Faults draw_faults(std::string_view cause, double level, std::mt19937_64& random) {
  if (!(level > 0) || !(level <= 2)) throw std::invalid_argument("level: give a number above 0 and at most 2");
  // Drawn for every cause alike, so that what is drawn afterwards does not depend on the cause.
  const double sign = uniform(random, 0, 1) < 0.5 ? -1 : 1;
  const double size = level * uniform(random, 0.85, 1.15);
  const double angle = uniform(random, 0, 2 * std::numbers::pi);
  const double along_x = size * std::cos(angle), along_y = size * std::sin(angle);
  Faults f;
  // Sizes that move points by 0.5 to 1 mm in the mean at level 1, as far as a plausible machine can.
  if (cause == "none") return f;
  else if (cause == "heating_gradient") f.colder_right_k = 13 * along_x, f.colder_back_k = 13 * along_y;
  else if (cause == "heating_centre") f.colder_corners_k = 13 * sign * size;
  else if (cause == "slip") f.slip = 3 * size;
  else if (cause == "anisotropy") f.anisotropy = 0.5 * sign * size;
  else if (cause == "thickness_wedge") f.thicker_right = 0.5 * along_x, f.thicker_back = 0.5 * along_y;
  else if (cause == "cooling") f.contact_w_per_m2_k = 2000 * size;
  else if (cause == "weak_vacuum") f.vacuum_lost = 0.75 * size;
  else if (cause == "clamp_slip") f.clamp_mm2_per_n_s = 35 * size;
  else if (cause == "mould_shift") f.mould_shift_x_mm = 2.8 * along_x, f.mould_shift_y_mm = 2.8 * along_y;
  else if (cause == "mould_rotation") f.mould_rotation_deg = 7 * sign * size;
  else if (cause == "mould_scale") f.mould_scale = 0.03 * sign * size;
  else if (cause == "print_scale") f.print_scale = 0.009 * sign * size;
  else if (cause == "print_stretch_x") f.print_stretch_x = 0.013 * sign * size;
  else if (cause == "print_stretch_y") f.print_stretch_y = 0.013 * sign * size;
  else if (cause == "print_skew") f.print_skew = 0.013 * sign * size;
  else if (cause == "scan_stretch_x") f.scan_stretch_x = 0.015 * sign * size;
  else if (cause == "scan_rotation")
    f.scan_turn_x_deg = 0.7 * along_x, f.scan_turn_y_deg = 0.7 * along_y, f.scan_turn_z_deg = 0.35 * sign * size;
  else if (cause == "scan_bow") f.scan_bow_mm = 0.9 * sign * size;
  else if (cause == "mould_leaning") f.mould_lean_right_deg = 2 * along_x, f.mould_lean_back_deg = 2 * along_y;
  else if (cause == "scan_scale") f.scan_scale = 0.01 * sign * size;
  else if (cause == "scan_shift")
    f.scan_shift_x_mm = 0.8 * along_x, f.scan_shift_y_mm = 0.8 * along_y, f.scan_shift_z_mm = 0.4 * sign * size;
  else {
    std::string list = "none";
    for (const std::string_view name : cause_names) list += ", " + std::string(name);
    throw std::invalid_argument("cause: '" + std::string(cause) + "' is not known; give one of " + list);
  }
  return f;
}

std::vector<std::pair<std::string, double>> values_of(const Faults& faults) {
  std::vector<std::pair<std::string, double>> values;
  for (const Named& entry : named)
    if (faults.*entry.value != 0) values.emplace_back(entry.name, faults.*entry.value);
  return values;
}

}  // namespace formwright::foreign_laboratory
