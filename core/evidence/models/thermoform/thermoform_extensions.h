// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What the simulation of a sheet can do that it usually leaves out: the assumptions of thesis 4.2.2 (the sheet sticks
// wherever it touches, the vacuum is there at once), its elastic law, its yield rule, no bending, and its numbers.
#include <vector>

#include "evidence/models/thermoform/thermoform_model.h"

namespace formwright {

struct ThermoformExtension {
  const char *name, *label, *explanation, *remedy;
  ExtensionTrial trial;
  const VariedParameter* parameter = nullptr;  // that it brings to fit; null where it is a setting alone
  Json settings = Json::object();              // parameters of ThermoformOptions
  void (*change)(ThermoformModelOptions&) = nullptr;
};

const std::vector<ThermoformExtension>& thermoform_extensions();

/// Among `options`, or in what set-up and profile say (`nominal`): there, at least as much as the extension has it.
bool has_extension(const ThermoformExtension& extension, const Json& nominal, const ThermoformModelOptions& options);

void apply_extension(const ThermoformExtension& extension, ThermoformModelOptions& options);

}  // namespace formwright
