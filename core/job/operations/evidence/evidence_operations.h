// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Evidence: what measured objects say about the simulation and the machine.
#include "job/contract/operation.h"

namespace formwright {
Operation evidence_calibrate_operation();          // fits the material to measured objects
Operation evidence_diagnose_operation();           // names the cause of a misfit
Operation evidence_diagnose_relief_operation();    // the same for a relief's shading
Operation evidence_diagnose_zippable_operation();  // the same for what was cut, sewn and zipped up
Operation evidence_plan_lengths_operation();       // which few lengths of a zipped object to measure
Operation evidence_virtual_object_operation();     // a measured object of a machine whose faults are chosen
Operation evidence_plan_points_operation();        // which few points to measure by hand, and what they would show
}  // namespace formwright
