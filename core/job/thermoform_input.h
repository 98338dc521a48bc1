// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What every operation on a formed sheet starts from: the model on the machine, and the sheet formed over it.
#include <memory>

#include "job/model_input.h"
#include "thermoform/formed_sheet.h"
#include "thermoform/thermoform_options.h"

namespace formwright {

struct FormedModel {
  std::shared_ptr<const LoadedModel> loaded;
  Placement placement;
  std::shared_ptr<const FormedSheet> sheet;
};

/// Reads the input "mould", places it, and takes the input "sheet".
/// Throws Error{invalid_input}: a sheet that is missing, or is not one of ours.
FormedModel formed_model(const OperationCall& call, const ThermoformOptions& options);

}  // namespace formwright
