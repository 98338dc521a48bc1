// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Which operations a program has. Each program links one of program.cpp, page.cpp and page_pictures.cpp.
#include <vector>

#include "job/contract/operation.h"

namespace formwright {

/// Every operation, in the order in which it is listed; evidence-register with or without its code.
std::vector<Operation> all_operations(Operation evidence_register);

}  // namespace formwright
