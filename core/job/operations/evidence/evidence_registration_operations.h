// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// From a printed pattern and a scan to measured points, thesis 4.2.3.
#include "job/contract/operation.h"

namespace formwright {
Operation evidence_pattern_operation();     // what is printed
Operation evidence_register_operation();    // what the scan of it says
Operation evidence_register_declaration();  // the same without the code that runs it
}  // namespace formwright
