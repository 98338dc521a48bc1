// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "job/operation.h"

namespace formwright {
Operation laser_job_operation();
}
