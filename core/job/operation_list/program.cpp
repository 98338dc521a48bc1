// SPDX-License-Identifier: GPL-3.0-or-later
// The native program: every operation with its code.
#include "job/catalog.h"
#include "job/operation_list/all_operations.h"
#include "job/operations/evidence/evidence_registration_operations.h"

namespace formwright {

const std::vector<Operation>& operations() {
  static const std::vector<Operation> list =
      all_operations(evidence_register_operation(), evidence_photographs_operation());
  return list;
}

}  // namespace formwright
