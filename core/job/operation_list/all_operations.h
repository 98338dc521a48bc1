// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Which operations a program has. Each program links one of program.cpp, page.cpp and page_pictures.cpp.
#include <vector>

#include "job/contract/operation.h"

namespace formwright {

/// Every operation, in the order in which it is listed; those that read photographs with or without their
/// code.
std::vector<Operation> all_operations(Operation evidence_register, Operation evidence_photographs);

}  // namespace formwright
