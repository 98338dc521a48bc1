// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/measured/measured_thickness.h"

#include <cstdio>

#include "base/data/number_table.h"
#include "base/error.h"
#include "thermoform/sheet/sheet_lookup.h"

namespace formwright {

std::vector<MeasuredThickness> read_measured_thickness(ByteView csv, const std::string& file_name) {
  const auto rows = read_number_table(
      csv, file_name, "measured",
      {{"sheet_x_mm"}, {"sheet_y_mm"}, {"thickness_mm", false, true}, {"thickness_sigma_mm", false}}, true);
  std::vector<MeasuredThickness> readings;
  for (const std::vector<double>& row : rows) {
    const auto refuse = [&](const char* sentence) {
      throw Error(ErrorCode::invalid_input, "measured",
                  file_name + ", thickness " + std::to_string(readings.size() + 1) + ": " + sentence);
    };
    if (!(row[2] > 0)) refuse("“thickness_mm” must be above zero; leave it blank where it was not measured.");
    if (row[3] < 0) refuse("“thickness_sigma_mm” is negative.");
    readings.push_back({Vec2(row[0], row[1]), row[2], row[3] > 0 ? row[3] : usual_thickness_sigma_mm});
  }
  return readings;
}

std::string add_measured_thickness(const std::string& text, const std::vector<MeasuredThickness>& readings) {
  if (readings.empty()) return text;
  std::string result;
  std::size_t begin = 0;
  for (bool header = true; begin < text.size(); header = false) {
    const std::size_t end = text.find('\n', begin);
    result += text.substr(begin, end - begin) + (header ? ",thickness_mm,thickness_sigma_mm\n" : ",,\n");
    begin = end == std::string::npos ? text.size() : end + 1;
  }
  char line[120];
  for (const MeasuredThickness& reading : readings) {
    std::snprintf(line, sizeof line, "%.7g,%.7g,,,,,%.7g,%.4g\n", reading.sheet_mm.x(), reading.sheet_mm.y(),
                  reading.thickness_mm, reading.sigma_mm);
    result += line;
  }
  return result;
}

Eigen::VectorXd predict_thickness(const FormedSheet& sheet, const TextureCoordinates& sheet_mm,
                                  const ThermoformOptions& o, const MeasurementEffects& effects) {
  const SheetLookup lookup(sheet);
  Eigen::VectorXd thickness(sheet_mm.rows());
  for (Eigen::Index i = 0; i < thickness.size(); ++i) {
    const Vec2 place = effects.on_sheet(sheet_mm.row(i).transpose());
    if (const auto at = lookup.find(place)) thickness[i] = lookup.thickness_mm(*at);
    else
      thickness[i] = o.sheet_thickness_mm *
                     thickness_factor(o, 2 * place.x() / o.clamp_opening_x_mm, 2 * place.y() / o.clamp_opening_y_mm);
  }
  return thickness;
}

}  // namespace formwright
