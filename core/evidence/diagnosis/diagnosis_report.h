// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A diagnosis as JSON, and as a page that a maker can read.
#include "base/data/json.h"
#include "evidence/diagnosis/diagnosis.h"
#include "evidence/diagnosis/simulation_choice.h"

namespace formwright {

struct SeparatedPair {
  NotSeparable pair;
  std::string what;       // the measurement that would tell; empty where none was found
  double similarity = 1;  // with it
};

/// Everything that is reported of a diagnosis.
struct DiagnosisReport {
  const ForwardModel& model;
  const Diagnosis& diagnosis;
  std::vector<SeparatedPair> separations;
  std::optional<HeldOutGain> unseen;
  std::vector<std::string> unseen_names, notes;
  std::string unit = "mm";
  SimulationChoice simulation{};             // which was chosen before causes were looked for
  std::vector<std::string> good_parts = {};  // names; what the simulation misses of them was added to its predictions
};

/// One sentence: what was found.
std::string verdict_sentence(const DiagnosisReport& report);
/// "Nothing wrong", "Uneven heating and Slip", "A cause that is not in the list", ...
std::string answer_label(const DiagnosisReport& report, const Answer& answer);
/// "verdict", "reading", "causes", "error_before_mm", ...; docs/evidence.md lists them.
Json diagnosis_json(const DiagnosisReport& report);
/// Self-contained HTML: no scripts, no links to anything outside.
std::string diagnosis_page(const DiagnosisReport& report);

}  // namespace formwright
