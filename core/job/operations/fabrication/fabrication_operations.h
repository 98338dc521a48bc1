// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "job/contract/operation.h"

namespace formwright {
Operation laser_job_operation();
Operation mill_job_operation();
Operation page_tiles_operation();
Operation test_grid_operation();
}  // namespace formwright
