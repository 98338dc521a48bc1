// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/operation_list/all_operations.h"

#include <utility>

#include "job/made_by.h"
#include "job/operations/evidence/evidence_operations.h"
#include "job/operations/evidence/evidence_registration_operations.h"
#include "job/operations/fabrication/fabrication_operations.h"
#include "job/operations/mesh/mesh_operations.h"
#include "job/operations/relief/forest/relief_forest_operation.h"
#include "job/operations/relief/relief_light_operation.h"
#include "job/operations/relief/relief_operation.h"
#include "job/operations/thermoform/thermoform_operations.h"
#include "job/operations/zippable/zippable_operation.h"

namespace formwright {

std::vector<Operation> all_operations(Operation evidence_register, Operation evidence_photographs) {
  std::vector<Operation> all = {relief_operation(),
                                relief_light_operation(),
                                relief_forest_operation(),
                                thermoform_simulate_operation(),
                                thermoform_texture_operation(),
                                thermoform_mould_operation(),
                                thermoform_compare_operation(),
                                evidence_pattern_operation(),
                                std::move(evidence_register),
                                std::move(evidence_photographs),
                                evidence_calibrate_operation(),
                                evidence_diagnose_operation(),
                                evidence_diagnose_relief_operation(),
                                evidence_diagnose_zippable_operation(),
                                evidence_virtual_object_operation(),
                                evidence_plan_points_operation(),
                                evidence_plan_lengths_operation(),
                                zippable_design_operation(),
                                zippable_plan_operation(),
                                zippable_simulate_operation(),
                                zippable_baseline_operation(),
                                laser_job_operation(),
                                mill_job_operation(),
                                test_grid_operation(),
                                page_tiles_operation(),
                                import_operation(),
                                simplify_operation(),
                                subdivide_operation(),
                                convert_operation(),
                                combine_operation()};
  for (Operation& operation : all) operation.report.push_back(made_by_field());
  return all;
}

}  // namespace formwright
