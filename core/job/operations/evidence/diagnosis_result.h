// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What every diagnosis hands out, whatever was diagnosed.
#include "evidence/diagnosis/diagnosis_report.h"
#include "job/contract/operation.h"

namespace formwright {

/// diagnosis.json and diagnosis.html.
std::vector<OutputInfo> diagnosis_outputs();
std::vector<ReportField> diagnosis_report_fields();
/// The report, and those of diagnosis_outputs() that the call wants.
OperationResult diagnosis_result(const OperationCall& call, const DiagnosisReport& report);

}  // namespace formwright
