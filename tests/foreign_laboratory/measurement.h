// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The formed sheet as a scan has it, and the folder of docs/measured_data.md.
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "foreign_laboratory/forming.h"

namespace formwright::foreign_laboratory {

struct Scan {
  int points = 2000;
  double noise_mm = 0.1;        // standard deviation of a coordinate where the sheet faces the scanner above
  double outlier_share = 0.02;  // points that were taken for others, 5 to 15 mm away on the flat sheet
};

struct MeasuredPoint {
  Eigen::Vector2d sheet_mm;  // as printed on the flat sheet, counted from its middle
  Eigen::Vector3d place_mm;
  double sigma_mm;
};

/// Places on the print where points are measured: one in each field of an even raster over the opening, 2 % of it away
/// from its sides.
std::vector<Eigen::Vector2d> draw_marks(const Machine& machine, int points, std::mt19937_64& random);

/// Where the scan has the marks when it makes no random error: on the outer face, half the thickness away from the
/// middle surface. 3 x n.
Points marked_places(const FormedSheet& sheet, const std::vector<Eigen::Vector2d>& marks, const Faults& faults);

/// Adds noise, up to twice as much where the surface leans away from the scanner, and outliers.
std::vector<MeasuredPoint> scan(const FormedSheet& sheet, const std::vector<Eigen::Vector2d>& marks,
                                const Faults& faults, const Scan& settings, std::mt19937_64& random);

struct Request {
  Mould mould = Mould::dome;
  std::string cause = "none";
  double level = 1;
  unsigned seed = 1;
  std::optional<unsigned> world_seed;  // of the machine and its plastic, where they are those of another object
  std::optional<unsigned> day_seed;    // formed on this day; without: as draw_world has the machine
  Scan scan;
  FormingOptions forming;
};

/// A formed and measured object as the files of its folder: mould.obj, setup.json, measured.csv, and truth.json, which
/// says what was hidden and how far it moved the marks against the sheet of the same seed without fault. The same
/// request gives the same bytes.
std::map<std::string, std::string> make_object(const Request& request);

}  // namespace formwright::foreign_laboratory
