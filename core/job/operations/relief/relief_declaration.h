// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What the operation "relief" makes and reports, its pieces apart.
#include <vector>

#include "job/contract/operation.h"

namespace formwright {

std::vector<OutputInfo> relief_outputs();
std::vector<ReportField> relief_report_fields();

}  // namespace formwright
