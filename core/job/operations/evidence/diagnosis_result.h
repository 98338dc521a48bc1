// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What every diagnosis hands out, whatever was diagnosed.
#include "evidence/diagnosis/diagnosis_report.h"
#include "evidence/diagnosis/separation.h"
#include "job/contract/operation.h"

namespace formwright {

/// diagnosis.json and diagnosis.html.
std::vector<OutputInfo> diagnosis_outputs();
std::vector<ReportField> diagnosis_report_fields();
/// The report, and those of diagnosis_outputs() that the call wants.
OperationResult diagnosis_result(const OperationCall& call, const DiagnosisReport& report);

/// The pairs of causes that do nearly the same, the two most alike first, since more would only confuse; each with the
/// proposal that distinguishes them best, where one helps. Throws Error{cancelled}.
std::vector<SeparatedPair> separated_pairs(SimulationBag& bag, const Diagnosis& diagnosis,
                                           const std::vector<ProposedMeasurement>& proposals, Context& context);

/// A name as a field of a table of comma-separated values.
std::string table_name(std::string name);

}  // namespace formwright
