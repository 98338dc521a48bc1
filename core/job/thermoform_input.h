// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What every operation on a formed sheet begins with: the model, placed, and the sheet as it forms over it.
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

/// Reads "mould", places it and takes the sheet from the input "sheet".
/// Throws Error{invalid_input}: no sheet, or one without the columns that the simulation writes.
FormedModel formed_model(const OperationCall& call, const ThermoformOptions& options);

}  // namespace formwright
