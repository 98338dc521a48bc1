// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Operations on models as such: what the page and the command line need around the crafts.
#include "job/contract/operation.h"

namespace formwright {
Operation import_operation();     // read, repair, measure
Operation simplify_operation();   // fewer vertices for a preview
Operation subdivide_operation();  // more vertices
Operation convert_operation();    // any format into any other
Operation combine_operation();    // several models into one
}  // namespace formwright
