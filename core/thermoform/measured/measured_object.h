// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A formed object that was measured: the folder of mould.obj, setup.json and measured.csv (docs/measured_data.md).
#include <string>
#include <vector>

#include "base/bytes.h"
#include "base/context.h"
#include "base/data/json.h"
#include "thermoform/sheet/formed_sheet.h"
#include "thermoform/measured/measurement_effects.h"
#include "thermoform/sheet/thermoform_options.h"

namespace formwright {

enum class MeasuredSurface { mid, outer };

/// setup.json: what the machine did. Keys that are not its own but name a parameter of the simulation are taken as
/// such.
struct ObjectSetup {
  Json parameters = Json::object();  // of ThermoformOptions, as far as the file gives them
  MeasuredSurface measured_surface = MeasuredSurface::mid;
  bool sheet_turned = false;       // lay in the clamp turned by half a turn: sheet coordinates count from its own edges
  double base_plate_end_z_mm = 0;  // the simulation has the raised plate at 0: add this to its z
  std::vector<std::string> notes;  // keys that were not understood
};

/// Throws Error{invalid_input, "setup"}, naming the key.
ObjectSetup read_object_setup(ByteView json);

/// setup.json of what `options` say of sheet and machine, without the material, the placement and the machine's faults.
/// Raised plate at z = 0.
Json write_object_setup(const ThermoformOptions& options, MeasuredSurface surface);

struct MeasuredPoint {
  Vec2 sheet_mm;    // on the flat sheet, centred on it
  Vec3 place_mm;    // machine coordinates
  double sigma_mm;  // standard deviation of the measurement; 0 when not known
};

/// measured.csv: header sheet_x_mm,sheet_y_mm,x_mm,y_mm,z_mm[,sigma_mm] in any order; a row whose x, y and z are all
/// blank is a point that was not measured, and is passed over. Throws Error{invalid_input,
/// "measured"} with the line; at least one row.
std::vector<MeasuredPoint> read_measured_points(ByteView csv, const std::string& file_name = "measured.csv");
std::string write_measured_points(const std::vector<MeasuredPoint>& points);

struct ComparedPoint {
  Vec3 simulated_mm;
  double error_mm;
  bool inside;  // of the clamp opening; outside the sheet lies flat in the clamp
};

struct Comparison {
  std::vector<ComparedPoint> points;  // as measured
  double mean_mm = 0, root_mean_square_mm = 0, median_mm = 0, percentile_90_mm = 0, percentile_95_mm = 0,
         maximum_mm = 0;
  double along_normal_mean_mm = 0;  // signed mean of measured minus simulated along the sheet's outward normal
  int outliers = 0;  // rows farther off than 5 robust standard deviations (1.4826 median) from the median
  double mean_without_outliers_mm = 0;
};

/// Where a scan of `sheet` would have the points with the given coordinates on the flat sheet (n x 2, centred on it): n
/// x 3. `clamp_z_mm`: of the clamped rim's middle surface, where points outside of the opening lie flat;
/// `base_plate_z_mm`: of the raised plate. Everything in the coordinates of the measured points.
Positions predict_measured(const FormedSheet& sheet, const TextureCoordinates& sheet_mm, MeasuredSurface surface,
                           double clamp_z_mm, double sheet_thickness_mm, const MeasurementEffects& effects,
                           double base_plate_z_mm = 0);

/// Compares points with what predict_measured has for them.
Comparison compare(const FormedSheet& sheet, const std::vector<MeasuredPoint>& points, MeasuredSurface surface,
                   double clamp_z_mm, double sheet_thickness_mm, const MeasurementEffects& effects,
                   double base_plate_z_mm, Context& context);

}  // namespace formwright
