// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How thick a formed sheet was measured to be, by a gauge or by cutting it, and what the simulation has for that.
#include <string>
#include <vector>

#include "base/bytes.h"
#include "thermoform/measured/measurement_effects.h"
#include "thermoform/sheet/formed_sheet.h"
#include "thermoform/sheet/thermoform_options.h"

namespace formwright {

/// Standard deviation of a reading where the file gives none: of a ball and a magnet, or of calipers at a cut edge.
inline constexpr double usual_thickness_sigma_mm = 0.05;

struct MeasuredThickness {
  Vec2 sheet_mm;        // on the flat sheet, centred on it
  double thickness_mm;  // > 0
  double sigma_mm;      // standard deviation of the measurement, > 0
};

/// The columns sheet_x_mm, sheet_y_mm, thickness_mm and thickness_sigma_mm of measured.csv. Rows with a blank
/// thickness_mm are passed over, with or without a place; nothing where the file has no such column. Throws
/// Error{invalid_input, "measured"} with the line, or with the number of a reading that is not above zero.
std::vector<MeasuredThickness> read_measured_thickness(ByteView csv, const std::string& file_name = "measured.csv");

/// Rows of measured.csv to come after those of points: `text` as write_measured_points has it.
std::string add_measured_thickness(const std::string& text, const std::vector<MeasuredThickness>& readings);

/// Thickness of `sheet` in mm at `sheet_mm` (n x 2, centred on the flat sheet, in the clamp's directions): n. Outside
/// of the clamp opening it is that of the sheet as delivered. `options`: what `sheet` was formed with.
Eigen::VectorXd predict_thickness(const FormedSheet& sheet, const TextureCoordinates& sheet_mm,
                                  const ThermoformOptions& options, const MeasurementEffects& effects);

}  // namespace formwright
