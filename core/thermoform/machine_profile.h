// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What is known of one machine: the material and the effects that were fitted to objects it made, as a small JSON file
// (docs/measured_data.md).
#include <string>
#include <vector>

#include "base/bytes.h"
#include "base/data/json.h"
#include "thermoform/measured/measurement_effects.h"

namespace formwright {

struct MachineProfile {
  std::string name;
  Json parameters = Json::object();  // of ThermoformOptions, as far as they are known; never of the placement
  MeasurementEffects measurement;
  std::vector<std::string> from;  // the objects it was learnt from
  std::vector<std::string> notes;
};

/// Throws Error{invalid_input, "profile"}, naming the key: no profile, another version, unknown names, values out of
/// range, placements.
MachineProfile read_machine_profile(ByteView json);

/// As read_machine_profile reads it. Throws Error{invalid_input, "profile"} for what that would refuse.
std::string write_machine_profile(const MachineProfile& profile);

/// Parameters of the material and of how it is loaded, which belong together: numbers fitted with one elastic law are
/// not another's.
std::vector<std::string> names_of_material();

/// The set-up's parameters with the profile's. A set-up holds a machine's settings, a profile what it does: where
/// both have a value, the profile's material, effects and vacuum ramp win, the set-up's other values do. What a person
/// gives by name goes over both.
Json with_profile(const Json& setup_parameters, const MachineProfile& profile);

}  // namespace formwright
