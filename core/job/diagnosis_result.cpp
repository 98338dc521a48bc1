// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/diagnosis_result.h"

#include "job/model_input.h"

namespace formwright {

std::vector<OutputInfo> diagnosis_outputs() {
  return {
      {"diagnosis.json", "application/json", "Diagnosis", "Verdict, causes, gains, what cannot be told apart.", true},
      {"diagnosis.html", "text/html", "Report", "The same to read: maps, histograms, ranked causes, what to do.",
       true}};
}

std::vector<ReportField> diagnosis_report_fields() {
  return {{"verdict", "Verdict", "", "one or more causes, none or unknown"},
          {"reading", "Reading", "", "none, cause, cannot_separate or unknown"},
          {"doubtful", "Doubtful", "", "what is named may be wrong, or not all"},
          {"doubts", "Doubts", "", "why, in words"},
          {"sentence", "In words", "", "what was found"},
          {"causes", "Causes", "",
           "name, label, probability, strength, unit, interval, values, remedy; the most probable first"},
          {"not_separable", "Not separable", "",
           "pairs of causes, how alike they are (0 to 1), the measurement that would tell"},
          {"error_before_mm", "Error before", "mm", "mean distance on held-out data, calibrated model"},
          {"error_before_interval_mm", "its interval", "mm", "95 %"},
          {"error_after_mm", "Error after", "mm", "the same, with the extended model"},
          {"error_after_interval_mm", "its interval", "mm", "95 %"},
          {"gain_share", "Gain", "", "1 - after / before"},
          {"gain_interval", "its interval", "", "95 %"},
          {"held_out", "Held out", "", "what was, in words"},
          {"unseen", "Unseen objects", "", "the same figures on objects that were not used"},
          {"noise_floor_mm", "Noise floor", "mm", "mean distance that noise alone gives"},
          {"noise", "Noise", "", "of each object: as found, as stated, outliers"},
          {"unexplained_before_mm", "Structure before", "mm", "size of smooth misfit that the calibrated model leaves"},
          {"unexplained_after_mm", "Structure after", "mm", "the same with the extended model"},
          {"structure_test", "Structure test", "",
           "agreement between neighbours' errors, its p-value and length, before and after"},
          {"trials", "Trials", "", "explanations that were asked to predict what was held out"},
          {"hypotheses", "Explanations", "",
           "the most probable: causes, with unknown structure or not, probability, log evidence"},
          {"parameters", "Material", "", "calibrated, and with the extended model"},
          {"simulations", "Simulations", "", "of the sheet"},
          {"seconds_calibration", "Calibration", "s", "part of the diagnosis"},
          {"seconds_diagnosis", "Diagnosis", "s", "all of it, without the unseen objects"},
          {"notes", "Notes", "", "in words"},
          {"peak_memory_mb", "Peak memory", "MB", "of the process"}};
}

OperationResult diagnosis_result(const OperationCall& call, const DiagnosisReport& report) {
  OperationResult result;
  result.report = diagnosis_json(report);
  for (const OutputInfo& info : diagnosis_outputs()) {
    if (!call.wants(info.name)) continue;
    result.outputs.push_back(make_output(
        info, to_bytes(info.name == "diagnosis.json" ? result.report.dump(2) + "\n" : diagnosis_page(report))));
  }
  return result;
}

}  // namespace formwright
