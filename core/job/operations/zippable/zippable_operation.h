// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "job/contract/operation.h"

namespace formwright {
Operation zippable_design_operation();
Operation zippable_plan_operation();
Operation zippable_simulate_operation();
Operation zippable_baseline_operation();
}  // namespace formwright
