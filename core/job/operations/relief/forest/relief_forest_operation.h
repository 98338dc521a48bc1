// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "job/contract/operation.h"

namespace formwright {
Operation relief_forest_operation();
}
