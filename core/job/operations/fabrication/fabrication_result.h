// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What jobs for machines have in common: outputs and report.
#include "fabrication/laser/laser_plan.h"
#include "job/contract/operation.h"

namespace formwright {

std::vector<OutputInfo> laser_job_outputs();
std::vector<ReportField> laser_report_fields();

/// Encodes what is wanted and fills the report. Files for machines are left out when the job does not fit.
void write_laser_result(OperationResult& result, const OperationCall& call, const std::vector<OutputInfo>& outputs,
                        LaserPlan& plan, const LaserMachineOptions& machine);

/// The report's fields on a tool path: times, lengths, bounds and whether it fits.
void report_toolpath(Json& report, const Toolpath& path, const std::vector<std::string>& misfits, int lines);

}  // namespace formwright
