// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What may be wrong with the machine, the sheet, the print or the scan. Every strength is of physics; here is how it
// relates to the parameter of the same meaning in core/thermoform (docs/thermoform.md, "What a real machine adds").
//
// | fault              | strength here                         | parameter there                                        |
// |--------------------|---------------------------------------|--------------------------------------------------------|
// | heating_gradient   | kelvin colder at the opening's edge   | direction alone; `stiffness_ratio` of polymer.h gives  |
// |                    | than in its middle, in x and y        | the factor on stiffness after one second               |
// | heating_centre     | kelvin colder in the corners than on  | direction alone, likewise                              |
// |                    | average, the middle as much hotter    |                                                        |
// | slip               | 1 / coefficient of Coulomb friction   | the same number; other rules of sticking               |
// | anisotropy         | Young's modulus along x times 1 + a   | the same along x; along y a little less than 1 - a     |
// | thickness_wedge    | relative slope over half the opening  | the same number                                        |
// | cooling            | W/(m^2 K) to a mould of 293 K         | direction alone: only what touches chills              |
// | weak_vacuum        | share of the vacuum lost              | the same number; here the pump's final vacuum          |
// | clamp_slip         | mm/s that a rim pulled by 1 N/mm      | direction alone: `clamp_feed_mm` of the result is the  |
// |                    | more than the clamp holds comes in    | mean way of the rim, unevenly along the sides          |
// | mould_shift, _rotation, _scale             | mm, degrees, share | the same numbers                                 |
// | print_scale, scan_scale, scan_shift        | share, share, mm   | the same numbers                                 |
// | print_stretch      | print too long along y alone, share   | none: no cause of the list                             |
#include <array>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace formwright::foreign_laboratory {

struct Faults {
  double colder_right_k = 0, colder_back_k = 0;
  double colder_corners_k = 0;
  double slip = 0;
  double anisotropy = 0;
  double thicker_right = 0, thicker_back = 0;
  double contact_w_per_m2_k = 0;  // beside what the machine in order has
  double vacuum_lost = 0;
  double clamp_mm2_per_n_s = 0;
  double mould_shift_x_mm = 0, mould_shift_y_mm = 0;
  double mould_rotation_deg = 0;
  double mould_scale = 0;
  double print_scale = 0;
  double print_stretch = 0;
  double scan_scale = 0;
  double scan_shift_x_mm = 0, scan_shift_y_mm = 0, scan_shift_z_mm = 0;
};

inline constexpr std::array<std::string_view, 15> cause_names = {
    "heating_gradient", "heating_centre", "slip",        "anisotropy",     "thickness_wedge",
    "cooling",          "weak_vacuum",    "clamp_slip",  "mould_shift",    "mould_rotation",
    "mould_scale",      "print_scale",    "scan_scale",  "scan_shift",     "print_stretch"};

/// Whether the diagnosis has the cause in its list.
inline bool is_in_the_list(std::string_view cause) { return cause != "print_stretch"; }

/// Whether the cause changes the measurement alone, and not the formed sheet.
bool acts_on_measurement(std::string_view cause);

/// `level`: 1 strong, 1/2 medium, 1/4 weak. Sign, direction and up to 15 % of the size are drawn. "none" has no fault.
/// Throws std::invalid_argument, which lists the names.
Faults draw_faults(std::string_view cause, double level, std::mt19937_64& random);

/// The faults that are not 0, by name.
std::vector<std::pair<std::string, double>> values_of(const Faults& faults);

/// Uniform between two bounds, with the same bits everywhere.
double uniform(std::mt19937_64& random, double low, double high);

}  // namespace formwright::foreign_laboratory
