// SPDX-License-Identifier: GPL-3.0-or-later
// The page's second module, with OpenCV: what reads photographs.
#include "job/catalog.h"
#include "job/operations/evidence/evidence_registration_operations.h"

namespace formwright {

const std::vector<Operation>& operations() {
  static const std::vector<Operation> list = {evidence_register_operation(), evidence_photographs_operation()};
  return list;
}

}  // namespace formwright
