// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/operations/evidence/measuring_form.h"

#include <algorithm>
#include <cstdio>

namespace formwright {

std::string measuring_form_csv(const MeasuringForm& form) {
  std::string text =
      "number,sheet_x_mm,sheet_y_mm,x_mm,y_mm,z_mm,sigma_mm,thickness_mm,thickness_sigma_mm,expected_x_mm,expected_y_mm,expected_z_mm\n";
  char line[240];
  int number = 1;
  for (const MeasuredPoint& p : form.measured) {
    std::snprintf(line, sizeof line, "%d,%.7g,%.7g,%.7g,%.7g,%.7g,%.4g,,,,,\n", number++, p.sheet_mm.x(),
                  p.sheet_mm.y(), p.place_mm.x(), p.place_mm.y(), p.place_mm.z(), p.sigma_mm);
    text += line;
  }
  for (const MeasuredThickness& t : form.measured_thickness) {
    std::snprintf(line, sizeof line, ",%.7g,%.7g,,,,,%.7g,%.4g,,,\n", t.sheet_mm.x(), t.sheet_mm.y(), t.thickness_mm,
                  t.sigma_mm);
    text += line;
  }
  for (const MeasuredPoint& p : form.marks) {
    std::snprintf(line, sizeof line, "%d,%.7g,%.7g,,,,%.4g,,,%.5g,%.5g,%.5g\n", number++, p.sheet_mm.x(),
                  p.sheet_mm.y(), p.sigma_mm, p.place_mm.x(), p.place_mm.y(), p.place_mm.z());
    text += line;
  }
  for (const RimPlace& place : form.rim) {
    std::snprintf(line, sizeof line, "rim %s,%.7g,%.7g,,,,,,%.4g,,,\n", place.side.c_str(), place.sheet_mm.x(),
                  place.sheet_mm.y(), usual_thickness_sigma_mm);
    text += line;
  }
  return text;
}

std::vector<RimPlace> rim_to_measure(const ThermoformOptions& options, const std::vector<MeasuredThickness>& measured) {
  constexpr double same_place_mm = 10;
  std::vector<RimPlace> places = rim_places(options);
  std::erase_if(places, [&](const RimPlace& place) {
    return std::any_of(measured.begin(), measured.end(), [&](const MeasuredThickness& reading) {
      return (reading.sheet_mm - place.sheet_mm).norm() < same_place_mm;
    });
  });
  return places;
}

}  // namespace formwright
