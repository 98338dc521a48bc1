// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What may be wrong with the machine, the sheet, the print or the scan. How a strength relates to the parameter of the
// same meaning in core/thermoform (docs/thermoform.md, "What a real machine adds"):
//
// The same number with the same meaning: slip (1 / Coulomb's coefficient, by other rules of sticking), thicker_right
// and thicker_back (thickness_wedge), vacuum_lost (weak_vacuum; here of the pump's final vacuum), mould_shift,
// mould_rotation, mould_scale, print_scale, print_stretch_x, print_stretch_y, scan_scale, scan_stretch_x,
// scan_turn (degrees about x, y, z), scan_shift.
// Nearly: anisotropy. Young's modulus along x is 1 + a times the even sheet's, along y a little more than 1 - a.
// The direction alone:
// - heating_gradient, heating_centre: here in kelvin. stiffness_ratio() gives the factor on stiffness after one second.
// - cooling: here the heat that a mould of 293 K takes from what touches it. Nothing cools beside the contact, where
//   the project has a reach of 10 mm, so that even water-cooled metal moves little.
// - clamp_slip: here a speed for each N/mm of pull. `clamp_feed_mm` of the result is the mean movement of the rim,
//   which is uneven along the sides.
// None, causes of no list: mould_leaning, print_skew, scan_bow.
#include <array>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace formwright::foreign_laboratory {

struct Faults {
  double colder_right_k = 0, colder_back_k = 0;  // at the opening's edge, than in its middle
  double colder_corners_k = 0;                   // than on average; the middle is as much hotter
  double slip = 0;
  double anisotropy = 0;
  double thicker_right = 0, thicker_back = 0;
  double contact_w_per_m2_k = 0;  // cooling, beside that of the machine in order
  double vacuum_lost = 0;
  double clamp_mm2_per_n_s = 0;  // mm/s for each N/mm beyond what the clamp holds
  double mould_shift_x_mm = 0, mould_shift_y_mm = 0;
  double mould_rotation_deg = 0;
  double mould_lean_right_deg = 0, mould_lean_back_deg = 0;
  double mould_scale = 0;
  double print_scale = 0;
  double print_stretch_x = 0, print_stretch_y = 0;
  double print_skew = 0;  // to the right, for each mm farther back
  double scan_scale = 0;
  double scan_stretch_x = 0;  // the scan is too long along x alone
  double scan_turn_x_deg = 0, scan_turn_y_deg = 0, scan_turn_z_deg = 0;
  double scan_bow_mm = 0;  // that the scan sinks by at 100 mm from its middle, as a dome
  double scan_shift_x_mm = 0, scan_shift_y_mm = 0, scan_shift_z_mm = 0;
};

inline constexpr std::array<std::string_view, 21> cause_names = {
    "heating_gradient", "heating_centre", "slip",          "anisotropy",  "thickness_wedge",
    "cooling",          "weak_vacuum",    "clamp_slip",    "mould_shift", "mould_rotation",
    "mould_scale",      "print_scale",    "scan_scale",    "scan_shift",  "print_stretch_y",
    "print_stretch_x",  "scan_stretch_x", "scan_rotation", "print_skew",  "scan_bow",
    "mould_leaning"};

/// Whether the diagnosis has the cause in its list.
inline bool is_in_the_list(std::string_view cause) {
  return cause != "print_skew" && cause != "scan_bow" && cause != "mould_leaning";
}

/// Whether the cause changes the measurement alone, and not the formed sheet.
bool acts_on_measurement(std::string_view cause);

/// `level`: 1 strong, 1/2 medium, 1/4 weak. Sign, direction and up to 15 % of the size are drawn. "none" has no fault.
/// Throws std::invalid_argument, which lists the names.
Faults draw_faults(std::string_view cause, double level, std::mt19937_64& random);

/// The faults that are not 0, by name.
std::vector<std::pair<std::string, double>> values_of(const Faults& faults);

/// Uniform between two bounds, with the same bits everywhere.
double uniform(std::mt19937_64& random, double low, double high);
/// Normal with mean 0 and standard deviation 1, the same way.
double normal(std::mt19937_64& random);

}  // namespace formwright::foreign_laboratory
