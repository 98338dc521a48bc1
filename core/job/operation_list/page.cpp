// SPDX-License-Identifier: GPL-3.0-or-later
// The page's first module: every operation is listed; what reads photographs has its code in the second.
#include "job/catalog.h"
#include "job/operation_list/all_operations.h"
#include "job/operations/evidence/evidence_registration_operations.h"

namespace formwright {

const std::vector<Operation>& operations() {
  static const std::vector<Operation> list =
      all_operations(evidence_register_declaration(), evidence_photographs_declaration());
  return list;
}

}  // namespace formwright
