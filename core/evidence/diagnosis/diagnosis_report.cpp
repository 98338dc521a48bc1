// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/diagnosis/diagnosis_report.h"

#include <algorithm>
#include <cmath>

namespace formwright {
namespace {

constexpr double min_similar = 0.5;     // CauseFinding::likeness of a cause that `unknown` is compared with
constexpr double min_reported = 0.001;  // of a probability: whatever is less likely is one

/// Probabilities that round to certainty are not reported as certain.
std::string percent(double share) {
  if (share > 0.99) return "over 99 %";
  return std::to_string(static_cast<int>(std::lround(100 * share))) + " %";
}

Json interval(double low, double high) { return Json::array({low, high}); }

Json noise_json(const ForwardModel& model, const Diagnosis& d) {
  Json list = Json::array();
  for (std::size_t i = 0; i < d.noise.size(); ++i)
    list.push_back({{"object", model.measurements()[i].name},
                    {"sigma_mm", d.noise[i].sigma / model.measurements()[i].scale},
                    {"stated_sigma_mm", d.noise[i].stated_sigma / model.measurements()[i].scale},
                    {"outliers", d.noise[i].outliers}});
  return list;
}

/// Errors, on held-out data, of other quantities than places.
Json other_quantities_json(const ForwardModel& model, const Diagnosis& d) {
  Json list = Json::array();
  for (const Measurement& m : model.measurements()) {
    if (m.is_place()) continue;
    const HeldOutGain& gain = d.held_out_others[list.size()];
    list.push_back({{"object", m.name},
                    {"readings", m.measured.rows()},
                    {"error_before_mm", gain.before.mean},
                    {"error_after_mm", gain.after.mean}});
  }
  return list;
}

Json structure_json(const ForwardModel& model, const std::vector<StructureTest>& tests) {
  Json list = Json::array();
  for (std::size_t i = 0; i < tests.size(); ++i)
    list.push_back({{"object", model.measurements()[i].name},
                    {"neighbour_correlation", tests[i].neighbour_correlation},
                    {"p_value", tests[i].p_value},
                    {"correlation_length_mm", tests[i].correlation_length_mm}});
  return list;
}

Json simulation_json(const SimulationChoice& choice) {
  Json list = Json::array();
  for (const TriedExtension& t : choice.tried)
    list.push_back({{"name", t.extension.name},
                    {"label", t.extension.label},
                    {"taken", t.taken},
                    {"fitted", t.fitted},
                    {"advised", t.advised},
                    {"explanation", t.extension.explanation},
                    {"remedy", t.extension.remedy},
                    {"log_evidence_gain", t.log_evidence_gain},
                    {"error_before_mm", t.error_before_mm},
                    {"error_after_mm", t.error_after_mm}});
  return list;
}

}  // namespace

std::string answer_label(const DiagnosisReport& report, const Answer& answer) {
  if (answer.causes.empty()) return answer.unknown_cause ? "A cause that is not in the list" : "Nothing wrong";
  std::string text;
  for (const int cause : answer.causes)
    text += (text.empty() ? "" : " and ") + report.model.causes()[static_cast<std::size_t>(cause)].label;
  return text + (answer.unknown_cause ? " and something else" : "");
}

std::string verdict_sentence(const DiagnosisReport& report) {
  const Diagnosis& d = report.diagnosis;
  const auto label = [&](int cause) { return report.model.causes()[static_cast<std::size_t>(cause)].label; };
  const auto probability = [&](int cause) {
    return std::find_if(d.causes.begin(), d.causes.end(), [&](const CauseFinding& f) { return f.cause == cause; })
        ->probability;
  };
  const bool beside = !report.good_parts.empty();
  if (d.reading == Reading::none)
    return beside ? "Nothing has changed since the good part: these data show no fault."
                  : "The calibrated simulation explains these data; they show no fault.";
  if (d.reading == Reading::unknown) {
    std::string text = std::string("The object differs from the ") + (beside ? "good part" : "simulation") +
                       ", and none of the known causes explains it.";
    const auto similar =
        std::max_element(d.causes.begin(), d.causes.end(),
                         [](const CauseFinding& a, const CauseFinding& b) { return a.likeness < b.likeness; });
    if (!d.verdict.empty()) text += " Nearest to it: " + label(d.verdict.front()) + ".";
    else if (similar != d.causes.end() && similar->likeness >= min_similar)
      text += " Most like it, but not enough: " + label(similar->cause) + ".";
    if (std::any_of(d.failed.begin(), d.failed.end(),
                    [](const FailedCheck& f) { return f.failure == Failure::other_material; }))
      text +=
          " Another material would explain it: the sheet was stiffer or softer, of another plastic, or all of it hotter or colder.";
    return text;
  }
  std::string text = label(d.verdict.front()) + ", " + percent(probability(d.verdict.front()));
  if (d.verdict.size() > 1) text += ", and " + label(d.verdict[1]) + ", " + percent(probability(d.verdict[1]));
  text += ".";
  if (d.reading == Reading::cannot_separate) text += " These data cannot distinguish it from another cause.";
  for (const std::string& doubt : d.doubts) text += " " + doubt;
  return text;
}

Json diagnosis_json(const DiagnosisReport& report) {
  const Diagnosis& d = report.diagnosis;
  const ForwardModel& model = report.model;
  const auto name = [&](int cause) { return model.causes()[static_cast<std::size_t>(cause)].name; };
  Json json;
  json["verdict"] = Json::array();
  if (d.reading == Reading::none) json["verdict"].push_back("none");
  else if (d.reading == Reading::unknown) json["verdict"].push_back("unknown");
  else
    for (const int cause : d.verdict) json["verdict"].push_back(name(cause));
  json["reading"] = reading_name(d.reading);
  json["doubtful"] = d.doubtful();
  json["doubts"] = d.doubts;
  json["sentence"] = verdict_sentence(report);
  const auto names = [&](const std::vector<int>& causes) {
    Json list = Json::array();
    for (const int cause : causes) list.push_back(name(cause));
    return list;
  };
  json["answers"] = Json::array();
  double others = 0;
  for (const Answer& answer : d.answers) {
    if (answer.probability < min_reported) {
      others += answer.probability;
      continue;
    }
    json["answers"].push_back({{"causes", names(answer.causes)},
                               {"unknown_cause", answer.unknown_cause},
                               {"label", answer_label(report, answer)},
                               {"probability", answer.probability}});
  }
  json["other_answers"] = others;
  json["failed"] = Json::array();
  for (const FailedCheck& f : d.failed) {
    if (f.failure == Failure::behind_failed) continue;
    json["failed"].push_back({{"causes", names(f.causes)},
                              {"label", answer_label(report, {f.causes, false, 0})},
                              {"kept", names(f.kept)},
                              {"check", failure_name(f.failure)},
                              {"sentence", failure_sentence(f.failure)},
                              {"fit_probability", f.fit_probability}});
  }
  json["causes"] = Json::array();
  for (const CauseFinding& f : d.causes) {
    const Cause& cause = model.causes()[static_cast<std::size_t>(f.cause)];
    Json values = Json::object();
    for (std::size_t i = 0; i < cause.parameters.size(); ++i)
      values[model.parameters()[static_cast<std::size_t>(cause.parameters[i])].name] = f.values[i];
    const Json visible = std::isfinite(f.min_visible_strength) ? Json(f.min_visible_strength) : Json();
    json["causes"].push_back({{"name", cause.name},
                              {"label", cause.label},
                              {"probability", f.probability},
                              {"strength", f.strength},
                              {"unit", cause.unit},
                              {"interval", f.fitted ? interval(f.low, f.high) : Json()},
                              {"values", values},
                              {"log_evidence", f.log_evidence},
                              {"likeness", f.likeness},
                              {"min_visible_strength", visible},
                              {"least_visible", visible},  // the name of version 0.1
                              {"in_words", f.fitted ? model.in_words(f.cause, f.values) : ""},
                              {"fault_of", fault_name(cause.fault_of)},
                              {"explanation", cause.explanation},
                              {"remedy", cause.remedy}});
  }
  json["trials"] = Json::array();
  for (const HeldOutTrial& trial : d.trials) {
    json["trials"].push_back({{"causes", names(trial.causes)},
                              {"significant", trial.significant},
                              {"gain_share", trial.gain.gain_share},
                              {"gain_interval", interval(trial.gain.gain_low, trial.gain.gain_high)}});
  }
  json["not_separable"] = Json::array();
  for (const SeparatedPair& s : report.separations)
    json["not_separable"].push_back({{"causes", {name(s.pair.cause_a), name(s.pair.cause_b)}},
                                     {"likeness", s.pair.similarity},
                                     {"measurement", s.what},
                                     {"likeness_with_it", s.similarity}});
  const HeldOutGain& gain = d.held_out;
  json["error_before_mm"] = gain.before.mean;
  json["error_before_interval_mm"] = interval(gain.before.low, gain.before.high);
  json["error_after_mm"] = gain.after.mean;
  json["error_after_interval_mm"] = interval(gain.after.low, gain.after.high);
  json["gain_share"] = gain.gain_share;
  json["gain_interval"] = interval(gain.gain_low, gain.gain_high);
  json["held_out"] =
      "Each object in 16 blocks; a quarter of them at a time left out of the fit and then predicted. Mean distance without outliers.";
  if (report.unseen)
    json["unseen"] = {{"objects", report.unseen_names},
                      {"error_before_mm", report.unseen->before.mean},
                      {"error_before_interval_mm", interval(report.unseen->before.low, report.unseen->before.high)},
                      {"error_after_mm", report.unseen->after.mean},
                      {"error_after_interval_mm", interval(report.unseen->after.low, report.unseen->after.high)},
                      {"gain_share", report.unseen->gain_share},
                      {"gain_interval", interval(report.unseen->gain_low, report.unseen->gain_high)}};
  if (!d.held_out_others.empty()) json["other_quantities"] = other_quantities_json(model, d);
  if (!report.good_parts.empty()) json["good_parts"] = report.good_parts;
  json["noise_floor_mm"] = d.noise_floor;
  json["noise"] = noise_json(model, d);
  json["unexplained_before_mm"] = d.unexplained_before;
  json["unexplained_after_mm"] = d.unexplained_after;
  json["structure_test"] = {{"before", structure_json(model, d.structure_before)},
                            {"after", structure_json(model, d.structure_after)}};
  json["hypotheses"] = Json::array();
  for (const Hypothesis& h : d.hypotheses) {
    if (json["hypotheses"].size() >= 12) break;
    json["hypotheses"].push_back({{"causes", names(h.causes)},
                                  {"unknown_structure", h.unknown_structure},
                                  {"probability", h.probability},
                                  {"log_evidence", h.log_evidence}});
  }
  json["parameters"] = Json::array();
  for (const int p : model.base_parameters()) {
    const ModelParameter& parameter = model.parameters()[static_cast<std::size_t>(p)];
    json["parameters"].push_back({{"name", parameter.name},
                                  {"label", parameter.label},
                                  {"unit", parameter.unit},
                                  {"nominal", parameter.nominal},
                                  {"calibrated", parameter.value(d.base.u[p])},
                                  {"extended", parameter.value(d.extended.u[p])}});
  }
  json["simulation"] = simulation_json(report.simulation);
  json["simulations"] = d.simulations + report.simulation.simulations;
  json["seconds_calibration"] = d.seconds_calibration;
  json["seconds_diagnosis"] = d.seconds + report.simulation.seconds;
  json["notes"] = report.notes;
  return json;
}

}  // namespace formwright
