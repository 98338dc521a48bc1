// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "evidence/diagnosis/simulation_choice.h"
#include "job/contract/operation_options.h"
#include "job/operations/evidence/evidence_input.h"
#include "job/operations/evidence/evidence_operations.h"
#include "job/contract/model_input.h"
#include "job/operations/thermoform/thermoform_input.h"

namespace formwright {

enum class CalibrationMethod { fit, grid };
template <>
struct EnumNames<CalibrationMethod> {
  static constexpr std::array<std::string_view, 2> names{"fit", "grid"};
  static constexpr std::array<std::string_view, 2> labels{"Fit", "Grid search"};
};

namespace {

struct CalibrateOptions {
  CalibrationMethod method = CalibrationMethod::fit;
  int triangles = 2500;
  int grid_values = 5;

  static constexpr auto parameters = std::tuple{
      parameter(
          "method", &CalibrateOptions::method, "Method",
          "Fit: improves the parameters step by step and reports how certain each one is. Grid search: tries every combination of a few values for each parameter; slower.")
          .group("Calibration"),
      parameter(
          "triangles", &CalibrateOptions::triangles, "Triangles", unit::none, 500, 40000,
          "Number of triangles in the simulated sheet. More are more accurate and take longer; 2,500 is usual here.")
          .group("Calibration")
          .slider(1000, 10000),
      parameter(
          "grid_values", &CalibrateOptions::grid_values, "Grid values", unit::none, 2, 9,
          "Number of values tried for each of the four parameters in a grid search: 5 need 625 simulations, 3 need 81.")
          .group("Calibration")
          .advanced()};
};

std::vector<OutputInfo> evidence_calibrate_outputs() {
  return {{"profile.json", "application/json", "Machine profile",
           "The fitted material, to be used in later simulations (--profile).", true},
          {"calibration.json", "application/json", "Calibration",
           "Fitted values, 95 % intervals and profile likelihoods.", true}};
}

std::vector<ReportField> evidence_calibrate_report_fields() {
  return {
      {"objects", "Objects", "", "Number of measured objects that were fitted."},
      {"points", "Measured points", "", "Number of measured points of all objects together."},
      {"error_nominal_mm", "Error before", "mm",
       "Mean distance between measurement and simulation with the parameters of the set-up."},
      {"error_mean_mm", "Error after", "mm",
       "Mean distance between measurement and simulation with the fitted parameters, over all points."},
      {"noise_mm", "Measuring noise", "mm", "Standard deviation of one measured coordinate, estimated from the data."},
      {"outliers", "Outliers", "", "Number of points that differ strongly from their neighbours."},
      {"parameters", "Fitted parameters", "",
       "Every fitted parameter with its value, unit, 95 % interval, and whether the data determine it."},
      {"not_identified", "Not determined", "", "Parameters that these data do not determine."},
      {"simulations", "Simulations", "", "Number of simulations that were run."},
      {"seconds_calibration", "Calibration", "s", "Time for the whole calibration."},
      {"peak_memory_mb", "Peak memory", "MB", "Largest amount of memory that the process used."},
      {"notes", "Notes", "", "What to know about the result, as sentences."}};
}

Json profile_json(const ForwardModel& model, const ParameterProfile& profile) {
  const ModelParameter& parameter = model.parameters()[static_cast<std::size_t>(profile.parameter)];
  Json points = Json::array();
  for (const ProfilePoint& point : profile.points)
    points.push_back({{"value", point.value}, {"log_likelihood", point.log_likelihood}});
  return {
      {"name", parameter.name}, {"label", parameter.label}, {"unit", parameter.unit},           {"value", profile.best},
      {"low", profile.low},     {"high", profile.high},     {"identified", profile.identified}, {"profile", points}};
}

int index_of(const ForwardModel& model, const std::string& name) {
  for (std::size_t p = 0; p < model.parameters().size(); ++p)
    if (model.parameters()[p].name == name) return static_cast<int>(p);
  return -1;
}

Calibration search(SimulationBag& bag, const CalibrateOptions& o, const Eigen::VectorXd& start, Context& context) {
  if (o.method == CalibrationMethod::fit) return calibrate(bag, context, start);
  const ForwardModel& model = bag.model();
  // The ranges of thesis 4.2.3.
  const std::vector<GridAxis> axes{{index_of(model, "young_modulus_pa"), 5e5, 5e6},
                                   {index_of(model, "creep_per_s"), 0, 1000},
                                   {index_of(model, "yield_strain"), 0, 0.1},
                                   {index_of(model, "viscosity_s"), 0, 1e-4}};
  return grid_search(bag, axes, o.grid_values,
                     {index_of(model, "mould_shift_x_mm"), index_of(model, "mould_shift_y_mm")}, 2, context);
}

OperationResult run_evidence_calibrate(const OperationCall& call, const CalibrateOptions& o) {
  require_each_once(call, "measured.csv");
  std::vector<FormedObject> objects;
  {
    const auto span = call.context.span(0, 0.01, "Reading the objects");
    objects = read_formed_objects(call, "object");
  }
  ThermoformModelOptions options;
  options.triangles = o.triangles;
  options.fit_mould_place = true;
  options.profile = read_profile_input(call);
  const ThermoformModel usual(std::move(objects), options);
  SimulationChoice choice;
  if (o.method == CalibrationMethod::fit) {
    const auto span = call.context.span(0.01, 0.3, "Choosing the simulation");
    choice = choose_simulation(usual.for_choosing(), call.context);
  }
  const ThermoformModel& model = usual.extended_by(choice.taken());
  SimulationBag bag(model);
  const Calibration calibration = [&] {
    const auto span = call.context.span(o.method == CalibrationMethod::fit ? 0.3 : 0.01, 1, "Calibrating");
    // The usual simulation is calibrated from the set-up as it is.
    return search(bag, o, choice.taken().empty() ? Eigen::VectorXd() : choice.u, call.context);
  }();

  MachineProfile profile = model.profile_at(calibration.u);
  // Where the mould stood is of these objects, not of the machine.
  for (const char* name : {"mould_shift_x_mm", "mould_shift_y_mm"}) profile.parameters.erase(name);
  if (profile.name.empty()) profile.name = "Calibrated machine";

  OperationResult result;
  Json& report = result.report;
  Json parameters = Json::array(), not_identified = Json::array(), notes = Json::array();
  for (const ParameterProfile& own : calibration.profiles) {
    Json entry = profile_json(model, own);
    if (!own.identified) not_identified.push_back(entry["name"]);
    entry.erase("profile");
    parameters.push_back(std::move(entry));
  }
  if (calibration.profiles.empty()) parameters = parameter_values(model, calibration.u, ParameterRole::base);
  for (const TriedExtension& t : choice.tried) {
    if (t.advised)
      notes.push_back(t.extension.label + ": not included, since it takes longer; the mean error would be " +
                      with_digits(t.error_after_mm, 2) + " instead of " + with_digits(t.error_before_mm, 2) + " mm. " +
                      t.extension.remedy);
    if (!t.taken) continue;
    const std::string sentence =
        t.extension.label + ": the usual simulation leaves that out, this profile includes it. " + t.extension.remedy;
    notes.push_back(sentence);
    profile.notes.push_back(sentence);
  }
  for (const Json& name : not_identified) {
    const std::string sentence = "These data do not tell " + name.get<std::string>() +
                                 ": its value may be anywhere in its interval, and predictions hardly change.";
    notes.push_back(sentence);
    profile.notes.push_back(sentence);
  }
  std::size_t points = 0;
  double noise_squares = 0;
  int outliers = 0;
  for (std::size_t i = 0; i < model.objects().size(); ++i) {
    points += model.objects()[i].points.size();
    noise_squares += std::pow(calibration.noise[i].sigma, 2) / static_cast<double>(model.objects().size());
    outliers += calibration.noise[i].outliers;
    if (calibration.noise[i].stated_sigma > 0 && (calibration.noise[i].scale > 1.5 || calibration.noise[i].scale < 0.6))
      notes.push_back(model.objects()[i].name + ": the points scatter " +
                      std::to_string(calibration.noise[i].scale).substr(0, 4) + " times as much as sigma_mm says.");
  }
  for (const FormedObject& object : model.objects())
    for (const std::string& note : object.setup.notes) notes.push_back(object.name + ": " + note);
  report["objects"] = model.objects().size();
  report["points"] = points;
  report["error_nominal_mm"] = calibration.error_nominal;
  report["error_mean_mm"] = calibration.error;
  report["noise_mm"] = std::sqrt(noise_squares);
  report["outliers"] = outliers;
  report["parameters"] = parameters;
  report["not_identified"] = not_identified;
  report["simulations"] = calibration.simulations + choice.simulations;
  report["seconds_calibration"] = calibration.seconds + choice.seconds;
  report["notes"] = notes;
  Json details = report;
  details["method"] = o.method == CalibrationMethod::fit ? "fit" : "grid";
  details["profiles"] = Json::array();
  for (const ParameterProfile& own : calibration.profiles) details["profiles"].push_back(profile_json(model, own));
  const auto add = [&](const char* name, const std::string& text) {
    for (const OutputInfo& info : evidence_calibrate_outputs())
      if (info.name == name && call.wants(name)) result.outputs.push_back(make_output(info, to_bytes(text)));
  };
  add("profile.json", write_machine_profile(profile));
  add("calibration.json", details.dump(2) + "\n");
  return result;
}

}  // namespace

Operation evidence_calibrate_operation() {
  Operation operation;
  operation.name = "evidence-calibrate";
  operation.title = "Calibrate";
  operation.summary =
      "Fits the material parameters of the hot sheet to measured objects and reports how certain each one is.";
  operation.inputs = {object_input_info("object", "Measured object",
                                        "A folder with mould.obj, setup.json and measured.csv.", true, true),
                      profile_input_info()};
  operation.outputs = evidence_calibrate_outputs();
  operation.report = evidence_calibrate_report_fields();
  operation.keeps_results = true;
  take_options<CalibrateOptions>(operation, run_evidence_calibrate);
  return operation;
}

}  // namespace formwright
