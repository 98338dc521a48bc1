// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/models/thermoform/formed_object.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/format.h"
#include "base/statistics.h"
#include "evidence/fit/noise_model.h"
#include "thermoform/sheet/thermoform_options.h"

namespace formwright {
namespace {

constexpr std::size_t min_sheet_points = 6;

struct UnitName {
  double factor;
  const char* name;
};
constexpr std::array<UnitName, 4> other_units{
    {{1e-3, "metres"}, {1 / 25.4, "inches"}, {0.1, "centimetres"}, {1e3, "micrometres"}}};

double spread(const std::vector<MeasuredPoint>& points, bool on_sheet) {
  // The range between the 5th and the 95th of a hundred, so that outliers do not count.
  double widest = 0;
  for (int k = 0; k < 2; ++k) {
    std::vector<double> values;
    for (const MeasuredPoint& p : points) values.push_back(on_sheet ? p.sheet_mm[k] : p.place_mm[k]);
    const double low = value_of_rank(values, values.size() / 20);
    widest = std::max(widest, value_of_rank(values, values.size() * 19 / 20) - low);
  }
  return widest;
}

void check_thickness(const FormedObject& object, const ThermoformOptions& options) {
  for (std::size_t i = 0; i < object.thickness.size(); ++i) {
    const MeasuredThickness& reading = object.thickness[i];
    const auto refuse = [&](const std::string& sentence) {
      throw Error(ErrorCode::invalid_input, "object",
                  object.name + ": measured.csv, thickness " + std::to_string(i + 1) + ": " + sentence);
    };
    const double share = reading.thickness_mm / options.sheet_thickness_mm;
    constexpr double max_share = 2.5, min_share = 0.005;  // stretched more than a hundredfold no sheet holds
    if (share > max_share || share < min_share)
      refuse("“thickness_mm” is " + with_digits(reading.thickness_mm, 3) + ", and the sheet was " +
             with_digits(options.sheet_thickness_mm, 3) + " mm thick: give it in millimetres.");
    if (std::abs(reading.sheet_mm.x()) > 0.5 * options.sheet_x_mm + 1 ||
        std::abs(reading.sheet_mm.y()) > 0.5 * options.sheet_y_mm + 1)
      refuse("it lies beyond the sheet of " + with_digits(options.sheet_x_mm, 3) + " x " +
             with_digits(options.sheet_y_mm, 3) +
             " mm: sheet_x_mm and sheet_y_mm count from the sheet's centre, in mm.");
  }
}

}  // namespace

void check_measured_object(const FormedObject& object) {
  const auto refuse = [&](const std::string& sentence) {
    throw Error(ErrorCode::invalid_input, "object", object.name + ": " + sentence);
  };
  if (object.points.size() < min_sheet_points)
    refuse("measured.csv has " + std::to_string(object.points.size()) + " points; at least " +
           std::to_string(min_sheet_points) + ", spread over the sheet, are needed.");
  const bool stated =
      std::all_of(object.points.begin(), object.points.end(), [](const MeasuredPoint& p) { return p.sigma_mm > 0; });
  if (object.points.size() < static_cast<std::size_t>(min_points_to_find_noise) && !stated)
    refuse("with " + std::to_string(object.points.size()) + " points, fewer than " +
           std::to_string(min_points_to_find_noise) +
           ", the noise cannot be found in the data: give sigma_mm for each point (0.3 is usual for calipers).");
  const auto options = read_parameters<ThermoformOptions>(object.setup.parameters);
  const double on_sheet = spread(object.points, true), in_space = spread(object.points, false);
  if (!(on_sheet > 0) || !(in_space > 0))
    refuse("all measured points lie in one place; measure points all over the sheet.");
  // The rim stays where it is: over the sheet a spread in space cannot differ much from that on the sheet.
  for (const UnitName& unit : other_units)
    if (std::abs(std::log(in_space / on_sheet / unit.factor)) < 0.35)
      refuse(std::string("x_mm, y_mm, z_mm of measured.csv seem to be in ") + unit.name + " (they spread over " +
             with_digits(in_space, 3) + ", the sheet's over " + with_digits(on_sheet, 3) +
             " mm): convert them to millimetres.");
  const double sheet_side = std::max(options.sheet_x_mm, options.sheet_y_mm);
  for (const UnitName& unit : other_units)
    if (std::abs(std::log(on_sheet / sheet_side / unit.factor)) < 0.35 && on_sheet < 0.2 * sheet_side &&
        in_space < 0.2 * sheet_side)
      refuse(std::string("all coordinates of measured.csv seem to be in ") + unit.name +
             ": convert them to millimetres.");
  int outside = 0;
  double far = 0;
  const double turn = object.setup.sheet_turned ? -1 : 1;
  std::vector<double> offsets, alternative;
  for (const MeasuredPoint& p : object.points) {
    if (std::abs(p.sheet_mm.x()) > 0.5 * options.sheet_x_mm + 1 ||
        std::abs(p.sheet_mm.y()) > 0.5 * options.sheet_y_mm + 1)
      ++outside;
    offsets.push_back((p.place_mm.head<2>() - turn * p.sheet_mm).norm());
    alternative.push_back((p.place_mm.head<2>() + turn * p.sheet_mm).norm());
  }
  if (2 * outside > static_cast<int>(object.points.size()))
    refuse("most of the measured points lie beyond the sheet of " + with_digits(options.sheet_x_mm, 3) + " x " +
           with_digits(options.sheet_y_mm, 3) + " mm: sheet_x_mm and sheet_y_mm count from the sheet's centre, in mm.");
  far = median(std::move(offsets));
  if (far > 0.35 * sheet_side && median(std::move(alternative)) < 0.35 * sheet_side)
    refuse(object.setup.sheet_turned
               ? "the points lie as on a sheet that was not turned: take “sheet_turned” out of setup.json."
               : "the points lie as on a sheet turned by half a turn: add \"sheet_turned\": true to setup.json.");
  if (far > 0.35 * sheet_side)
    refuse(
        "the measured points lie " + with_digits(far, 3) +
        " mm beside their places on the sheet: bring the scan into the machine's coordinates, origin in the middle of the clamp "
        "opening, x and y as on the sheet.");
  check_thickness(object, options);
}

void check_mould_of(const FormedObject& object) {
  if (object.mould == nullptr || object.mould->mesh.V.rows() == 0) return;
  const double plate = object.setup.base_plate_end_z_mm, top = object.mould->mesh.V.col(2).maxCoeff() - plate;
  std::vector<double> heights;
  for (const MeasuredPoint& p : object.points) heights.push_back(p.place_mm.z() - plate);
  const double high = value_of_rank(heights, static_cast<std::size_t>(0.98 * static_cast<double>(heights.size() - 1)));
  constexpr double min_height_mm = 5;  // below that the sheet's thickness and the clamp's height count as well
  if (high < min_height_mm || top <= 0) return;
  for (const UnitName& unit : other_units)
    if (std::abs(std::log(top / high / unit.factor)) < 0.5)
      throw Error(ErrorCode::invalid_input, "object",
                  object.name + ": mould.obj seems to be in " + unit.name + " (its top is at " + with_digits(top, 3) +
                      ", measured points reach " + with_digits(high, 3) + " mm): convert it to millimetres.");
}

std::string rim_note(const FormedObject& object) {
  const auto o = read_parameters<ThermoformOptions>(object.setup.parameters);
  const bool outer = object.setup.measured_surface == MeasuredSurface::outer;
  const double held = o.clamp_height_mm + object.setup.base_plate_end_z_mm + (outer ? 0.5 * o.sheet_thickness_mm : 0.0);
  std::vector<double> heights;
  double sigma = 0;
  for (const MeasuredPoint& p : object.points)
    if (std::abs(p.sheet_mm.x()) > 0.5 * o.clamp_opening_x_mm + 1 ||
        std::abs(p.sheet_mm.y()) > 0.5 * o.clamp_opening_y_mm + 1) {
      heights.push_back(p.place_mm.z());
      sigma = std::max(sigma, p.sigma_mm);
    }
  constexpr std::size_t fewest_of_rim = 12;
  if (heights.size() < fewest_of_rim) return {};
  const double off = median(heights) - held;
  if (std::abs(off) < std::max(0.3, 3 * sigma / std::sqrt(static_cast<double>(heights.size())))) return {};
  return "The clamped rim was measured " + with_digits(std::abs(off), 3) + " mm " + (off > 0 ? "above" : "below") +
         " where setup.json has it (clamp_height_mm, sheet_thickness_mm, measured_surface): if the scan was aligned by "
         "its rim, register it again with the same values; else the whole scan may be off its place.";
}

}  // namespace formwright
