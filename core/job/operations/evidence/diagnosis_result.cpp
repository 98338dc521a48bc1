// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/operations/evidence/diagnosis_result.h"

#include <algorithm>

#include "job/contract/model_input.h"

namespace formwright {

std::vector<OutputInfo> diagnosis_outputs() {
  return {{"diagnosis.json", "application/json", "Diagnosis",
           "The verdict, the causes, the gains, and causes that cannot be distinguished.", true},
          {"diagnosis.html", "text/html", "Report",
           "The diagnosis as a page to read: maps, histograms, ranked causes and remedies.", true}};
}

std::vector<ReportField> diagnosis_report_fields() {
  return {
      {"verdict", "Verdict", "",
       "The names of one or more causes, none (nothing is wrong) or unknown (none of the known causes)."},
      {"reading", "Kind of verdict", "",
       "none (nothing wrong), cause (causes named), cannot_separate (two causes equally likely) or unknown (no known cause explains it)."},
      {"doubtful", "Doubtful", "", "Whether the named causes may be wrong or incomplete."},
      {"doubts", "Doubts", "", "Why the verdict is doubtful, as sentences."},
      {"sentence", "In words", "", "What was found, as a sentence."},
      {"answers", "Answers", "",
       "What may be wrong, the most probable first: nothing, a cause, several, or a cause that is not in the list. Their probabilities and that of all other answers add up to 1."},
      {"other_answers", "All other answers", "",
       "Probability of all answers that are not listed, each less than 0.001."},
      {"failed", "Failed checks", "", "Causes that would fit but failed a check, and why, as a sentence."},
      {"causes", "Causes", "",
       "Every cause with its name, probability, strength, unit, 95 % interval, values, remedy and whose it is (fault_of: machine, measurement or simulation); the most probable first."},
      {"not_separable", "Not distinguishable", "",
       "Pairs of causes with similar effects, how similar they are (0 to 1), and the measurement that would distinguish them."},
      {"error_before_mm", "Error before", "mm",
       "Mean distance between measurement and calibrated simulation on held-out data."},
      {"error_before_interval_mm", "Interval of the error before", "mm",
       "95 % interval of the mean error before causes are included."},
      {"error_after_mm", "Error after", "mm",
       "Mean distance between measurement and simulation on held-out data with the named causes included."},
      {"error_after_interval_mm", "Interval of the error after", "mm",
       "95 % interval of the mean error with the named causes included."},
      {"gain_share", "Gain", "", "Fraction of the error that the named causes remove: 1 - error after / error before."},
      {"gain_interval", "Interval of the gain", "", "95 % interval of the gain."},
      {"held_out", "Held-out data", "", "Which data were held out to measure the errors, as a sentence."},
      {"unseen", "Validation objects", "", "Errors before and after on objects that were not used for fitting."},
      {"good_parts", "Good parts", "",
       "Names of the good parts that were given: what the simulation misses of them was added to what it predicts."},
      {"other_quantities", "Thickness", "",
       "Mean errors of the thickness, where it was measured, on held-out data: before and after the named causes are included."},
      {"noise_floor_mm", "Noise floor", "mm", "Mean distance that measuring noise alone would give."},
      {"noise", "Noise", "", "Noise of every object: as found, as stated in the data, and the number of outliers."},
      {"unexplained_before_mm", "Pattern left before", "mm",
       "Size of the smooth error that the calibrated simulation leaves unexplained."},
      {"unexplained_after_mm", "Pattern left after", "mm",
       "Size of the smooth error that remains with the named causes included."},
      {"structure_test", "Test for a pattern", "",
       "How much neighbouring errors agree, with p-value and correlation length, before and after the named causes are included."},
      {"trials", "Trials", "", "Number of explanations that were tested on held-out data."},
      {"hypotheses", "Explanations", "",
       "The explanations that fit best, before any check: their causes, whether an unknown pattern remains, probability and log evidence."},
      {"parameters", "Material", "", "Material parameters, calibrated alone and with the named causes included."},
      {"simulation", "Simulation", "",
       "What the simulation leaves out and was tried with before causes were looked for: whether it was taken, fitted or got one look, or is advised; how much better it fits, the calibrated mean error without and with it, and the setting that does it."},
      {"simulations", "Simulations", "", "Number of simulations that were run."},
      {"seconds_calibration", "Calibration", "s", "Time for the calibration, part of the diagnosis."},
      {"seconds_diagnosis", "Diagnosis", "s", "Time for the whole diagnosis, without the validation objects."},
      {"notes", "Notes", "", "What to know about the result, as sentences."},
      {"peak_memory_mb", "Peak memory", "MB", "Largest amount of memory that the process used."}};
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

std::vector<SeparatedPair> separated_pairs(SimulationBag& bag, const Diagnosis& diagnosis,
                                           const std::vector<ProposedMeasurement>& proposals, Context& context) {
  constexpr std::size_t max_pairs = 2;
  constexpr double min_sigma = 1e-3;  // measurements without any noise distinguish everything
  std::vector<NotSeparable> pairs = diagnosis.not_separable;
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const NotSeparable& a, const NotSeparable& b) { return a.similarity > b.similarity; });
  if (pairs.size() > max_pairs) pairs.resize(max_pairs);
  std::vector<SeparatedPair> separations;
  for (const NotSeparable& pair : pairs) {
    SeparatedPair separated{pair, "", pair.similarity};
    const Separation found = proposals.empty()
                                 ? Separation{}
                                 : best_separation(bag, diagnosis, pair, proposals,
                                                   std::max(diagnosis.noise.front().sigma, min_sigma), context);
    if (found.proposal >= 0)
      separated.what = proposals[static_cast<std::size_t>(found.proposal)].what,
      separated.similarity = found.similarity;
    separations.push_back(std::move(separated));
  }
  return separations;
}

std::string table_name(std::string name) {
  for (char& c : name)
    if (c == ',' || c == '"' || c == '\n' || c == '\r') c = '_';
  return name;
}

}  // namespace formwright
