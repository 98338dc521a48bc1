// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What was measured of a formed sheet, checked before anything is simulated.
#include <memory>
#include <string>
#include <vector>

#include "thermoform/forming.h"
#include "thermoform/measured/measured_object.h"
#include "thermoform/measured/measured_thickness.h"

namespace formwright {

/// One measured object, read and checked.
struct FormedObject {
  std::string name;
  std::string key;  // names the mould's content
  std::shared_ptr<const MouldShape> mould;
  ObjectSetup setup;
  std::vector<MeasuredPoint> points;
  std::vector<MeasuredThickness> thickness;  // may be empty
};

/// Throws Error{invalid_input, "object"}: too few points, or points that are not in mm or not where the machine is,
/// with the likely reason; thickness that is not in mm or beyond the sheet.
void check_measured_object(const FormedObject& object);

/// Throws Error{invalid_input, "object"} where the mould is in another unit than the measured points.
void check_mould_of(const FormedObject& object);

/// A sentence where the clamped rim was not measured where the set-up has it; else empty.
std::string rim_note(const FormedObject& object);

}  // namespace formwright
