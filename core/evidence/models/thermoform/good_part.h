// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A part from when the machine was in order. What the simulation misses of it, it misses of the next over the same
// mould as well, and no cause is to be blamed for that: what has changed since is what a diagnosis looks for.
#include <vector>

#include "evidence/diagnosis/simulation_choice.h"
#include "evidence/models/thermoform/thermoform_model.h"

namespace formwright {

struct MachineInOrder {
  MachineProfile profile;  // the material that the parts were formed of, as it was calibrated
  SimulationChoice choice;
  double error_mm = 0;  // mean distance that is left: what the simulation misses, and noise
};

/// Chooses the simulation and calibrates it to good parts. Throws Error{could_not_solve, cancelled}.
MachineInOrder machine_in_order(const std::vector<FormedObject>& good_parts, const ThermoformModelOptions& options,
                                Context& context);

/// The same shape in the same place, however its triangles are written: no vertex (of some 500 of each) is farther than
/// 0.2 mm from the other.
bool same_mould(const FormedObject& a, const FormedObject& b);

/// Throws Error{invalid_input, "good"} where a part was formed over a mould that is none of the objects'.
void check_good_parts(const std::vector<FormedObject>& good_parts, const std::vector<FormedObject>& objects);

}  // namespace formwright
