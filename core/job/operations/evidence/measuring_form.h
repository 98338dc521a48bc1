// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The table that a maker fills in: marks of the sheet, and places of its rim.
#include <string>
#include <vector>

#include "evidence/models/thermoform/rim_thickness.h"

namespace formwright {

/// What is measured already, then the marks and the places of the rim to measure.
struct MeasuringForm {
  std::vector<MeasuredPoint> measured, marks;
  std::vector<MeasuredThickness> measured_thickness;
  std::vector<RimPlace> rim;
};

/// measured.csv with blanks to fill in. Columns beyond those that are read say where each mark is expected.
std::string measuring_form_csv(const MeasuringForm& form);

/// Places of the rim that have no reading yet.
std::vector<RimPlace> rim_to_measure(const ThermoformOptions& options, const std::vector<MeasuredThickness>& measured);

}  // namespace formwright
