// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Values that belong together, under a name that people know: a plastic, a machine, a cloth.
#include <string>
#include <vector>

#include "base/data/json.h"

namespace formwright {

struct Preset {
  std::string name, title;  // "petg", "PETG"
  Json parameters;          // values of an operation's parameters, to begin with
  std::string hint = "";    // what to mind with it; may be empty
};

/// "Plastic" with its presets, which all set the same parameters.
struct PresetList {
  std::string name, title, help;
  std::string group;  // of the parameters beside which it stands
  std::vector<Preset> presets;
};

}  // namespace formwright
