// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// From a printed pattern and a scan (thesis 4.2.3) or photographs to measured points.
#include "job/contract/operation.h"

namespace formwright {
Operation evidence_pattern_operation();      // what is printed
Operation evidence_register_operation();     // what the scan of it says
Operation evidence_register_declaration();   // the same without the code that runs it
Operation evidence_photographs_operation();  // what photographs of it say
Operation evidence_photographs_declaration();
}  // namespace formwright
