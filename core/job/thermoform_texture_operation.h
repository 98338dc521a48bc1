// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "job/operation.h"

namespace formwright {
Operation thermoform_texture_operation();  // the picture to print on the flat sheet (thesis 4.2.4)
}  // namespace formwright
