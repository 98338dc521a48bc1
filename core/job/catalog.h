// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "job/contract/operation.h"

namespace formwright {

/// Every operation, in the order in which it is listed.
const std::vector<Operation>& operations();

/// Null when there is none of that name.
const Operation* find_operation(const std::string& name);

/// The whole declaration as docs/job_contract.md describes it.
Json catalog_json();

/// JSON of one operation, as it stands in the catalog.
Json operation_json(const Operation& operation);

/// The version of this build, "0.2.0".
const char* version();

}  // namespace formwright
