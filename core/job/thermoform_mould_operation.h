// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "job/operation.h"

namespace formwright {

/// "thermoform-mould": see docs/thermoform_mould.md.
Operation thermoform_mould_operation();

}  // namespace formwright
