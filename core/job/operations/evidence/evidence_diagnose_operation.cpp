// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "base/error.h"
#include "base/format.h"
#include "evidence/diagnosis/unseen.h"
#include "evidence/models/thermoform/good_part.h"
#include "evidence/models/thermoform/proposals.h"
#include "geometry/queries/crossings.h"
#include "job/contract/operation_options.h"
#include "job/operations/evidence/diagnosis_result.h"
#include "job/operations/evidence/evidence_input.h"
#include "job/operations/evidence/evidence_operations.h"
#include "job/contract/model_input.h"
#include "job/operations/thermoform/thermoform_input.h"

namespace formwright {
namespace {

struct DiagnoseOptions {
  bool pairs = true;
  bool separate = true;
  int triangles = 2500;

  static constexpr auto parameters = std::tuple{
      parameter("pairs", &DiagnoseOptions::pairs, "Two causes at once",
                "Also looks for two causes acting together. Takes longer; switch it off for a quick look.")
          .group("Diagnosis"),
      parameter(
          "separate", &DiagnoseOptions::separate, "Propose a measurement",
          "If two causes explain the data equally well, looks for a further measurement that would distinguish them.")
          .group("Diagnosis"),
      parameter(
          "triangles", &DiagnoseOptions::triangles, "Triangles", unit::none, 500, 40000,
          "Number of triangles in the sheet on which causes are searched. More are more accurate and take longer. Up to 5,000, the answer is fitted once more on a sheet with twice as many.")
          .group("Diagnosis")
          .slider(1000, 10000)};
};

std::vector<OutputInfo> evidence_diagnose_outputs() {
  std::vector<OutputInfo> list = diagnosis_outputs();
  list.push_back({"profile.json", "application/json", "Machine profile",
                  "The material and causes found, to be used in later simulations (--profile).", true});
  list.push_back(
      {"residuals.csv", "text/csv", "Residuals",
       "Every measured point, of validation objects too, with its position in the calibrated simulation and in the one that includes the causes.",
       true});
  list.push_back(
      {"thickness.csv", "text/csv", "Thickness",
       "Every thickness reading, with the thickness of the calibrated simulation and of the one that includes the causes; only where thickness was measured.",
       true});
  return list;
}

/// Rows of residuals.csv, an object after the other.
std::string residual_rows(const std::vector<FormedObject>& objects, const Predictions& calibrated,
                          const Predictions& extended, const std::vector<Eigen::VectorXd>& weights) {
  std::string text;
  char line[320];
  for (std::size_t object = 0; object < objects.size(); ++object) {
    const FormedObject& own = objects[object];
    const std::string name = table_name(own.name);
    for (std::size_t i = 0; i < own.points.size(); ++i) {
      const MeasuredPoint& p = own.points[i];
      const auto row = static_cast<Eigen::Index>(i);
      const auto before = calibrated[object].row(row), after = extended[object].row(row);
      std::snprintf(line, sizeof line, ",%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,%.4g\n", p.sheet_mm.x(),
                    p.sheet_mm.y(), p.place_mm.x(), p.place_mm.y(), p.place_mm.z(), before[0], before[1], before[2],
                    after[0], after[1], after[2], weights[object][row]);
      text += name + line;
    }
  }
  return text;
}

std::string residuals_csv(const ThermoformModel& model, const Diagnosis& d, const ThermoformModel* other,
                          const std::optional<UnseenObjects>& unseen) {
  std::string text =
      "object,sheet_x_mm,sheet_y_mm,x_mm,y_mm,z_mm,calibrated_x_mm,calibrated_y_mm,calibrated_z_mm,extended_x_mm,extended_y_mm,extended_z_mm,weight\n";
  std::vector<Eigen::VectorXd> weights;
  for (const NoiseEstimate& noise : d.noise) weights.push_back(noise.weights);
  text += residual_rows(model.objects(), d.base.predictions, d.extended.predictions, weights);
  if (unseen) text += residual_rows(other->objects(), unseen->base, unseen->extended, unseen->weights);
  return text;
}

/// Rows of thickness.csv, an object after the other.
std::string thickness_rows(const ThermoformModel& model, const Predictions& calibrated, const Predictions& extended,
                           const std::vector<Eigen::VectorXd>& weights) {
  std::string text;
  char line[240];
  for (std::size_t m = model.objects().size(); m < model.measurements().size(); ++m) {
    const double scale = model.measurements()[m].scale;
    const std::vector<MeasuredThickness>& readings = model.thickness_readings(m);
    for (std::size_t i = 0; i < readings.size(); ++i) {
      const MeasuredThickness& reading = readings[i];
      const auto row = static_cast<Eigen::Index>(i);
      std::snprintf(line, sizeof line, ",%.7g,%.7g,%.5g,%.4g,%.5g,%.5g,%.4g\n", reading.sheet_mm.x(),
                    reading.sheet_mm.y(), reading.thickness_mm, reading.sigma_mm, calibrated[m](row, 0) / scale,
                    extended[m](row, 0) / scale, weights[m][row] * scale * scale);
      text += table_name(model.objects()[static_cast<std::size_t>(model.measurements()[m].places_index)].name) + line;
    }
  }
  return text;
}

/// Empty where no thickness was measured.
std::string thickness_csv(const ThermoformModel& model, const Diagnosis& d, const ThermoformModel* other,
                          const std::optional<UnseenObjects>& unseen) {
  std::vector<Eigen::VectorXd> weights;
  for (const NoiseEstimate& noise : d.noise) weights.push_back(noise.weights);
  std::string rows = thickness_rows(model, d.base.predictions, d.extended.predictions, weights);
  if (unseen) rows += thickness_rows(*other, unseen->base, unseen->extended, unseen->weights);
  if (rows.empty()) return {};
  return "object,sheet_x_mm,sheet_y_mm,thickness_mm,sigma_mm,calibrated_mm,extended_mm,weight\n" + rows;
}

/// How often an object's sheet goes through itself at u; 0 where it has no answer there, as where u was found on a
/// finer sheet.
int crossings_of(const ThermoformModel& model, int object, const Eigen::VectorXd& u, Context& context) {
  try {
    return count_crossings(model.formed(object, u, context)->mesh, {}, context);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::could_not_solve) throw;
    return 0;
  }
}

OperationResult run_evidence_diagnose(const OperationCall& call, const DiagnoseOptions& o) {
  require_each_once(call, "measured.csv");
  ThermoformModelOptions options;
  options.triangles = o.triangles;
  options.profile = read_profile_input(call);
  std::vector<FormedObject> unseen, objects, good_parts;
  {
    const auto span = call.context.span(0, 0.01, "Reading the objects");
    unseen = read_formed_objects(call, "unseen");
    objects = read_formed_objects(call, "object");
    good_parts = read_formed_objects(call, "good");
    check_good_parts(good_parts, objects);
  }
  // An object that cannot be formed is refused before the fits, which take minutes.
  std::unique_ptr<const ThermoformModel> other;
  if (!unseen.empty()) {
    const auto span = call.context.span(0.01, 0.02, "Simulating the validation object");
    other = std::make_unique<const ThermoformModel>(unseen, options);
    for (std::size_t i = 0; i < other->objects().size(); ++i)
      other->predict(static_cast<int>(i), other->nominal(), call.context);
  }
  std::optional<MachineInOrder> in_order;
  if (!good_parts.empty()) {
    const auto span = call.context.span(0.02, 0.25, "Looking at the good part");
    in_order = machine_in_order(good_parts, options, call.context);
    options.profile = in_order->profile;
    options.good_parts = std::make_shared<const std::vector<FormedObject>>(std::move(good_parts));
    if (other) other = std::make_unique<const ThermoformModel>(std::move(unseen), options);
  }
  const ThermoformModel usual(std::move(objects), options);
  const SimulationChoice choice = [&] {
    // What the simulation misses of a good part needs no other simulation to account for it.
    if (in_order) return SimulationChoice{};
    const auto span = call.context.span(0.02, 0.25, "Choosing the simulation");
    return choose_simulation(usual.for_choosing(), call.context);
  }();
  const ThermoformModel& model = usual.extended_by(choice.taken());
  SimulationBag bag(model);
  Diagnosis diagnosis;
  {
    const auto span = call.context.span(0.25, o.separate ? 0.85 : 0.95, "Diagnosing");
    DiagnosisOptions own;
    own.pairs = o.pairs;
    own.start = choice.u;
    diagnosis = diagnose(bag, own, call.context);
  }
  DiagnosisReport report{model, diagnosis, {}, std::nullopt, {}, {}};
  report.simulation = in_order ? in_order->choice : choice;
  if (!diagnosis.not_separable.empty()) {
    const auto span = call.context.span(0.85, 0.95, "Looking for a measurement that distinguishes them");
    std::vector<ProposedMeasurement> proposals;
    if (o.separate) proposals = proposed_measurements(model, model.options());
    report.separations = separated_pairs(bag, diagnosis, proposals, call.context);
  }
  std::optional<UnseenObjects> predicted;
  if (other) {
    const auto span = call.context.span(0.95, 0.99, "Predicting the validation object");
    for (const FormedObject& object : other->objects()) report.unseen_names.push_back(object.name);
    try {
      predicted = predict_unseen(other->extended_by(choice.taken()), model, diagnosis, call.context);
      report.unseen = predicted->gain;
    } catch (const Error& error) {
      if (error.code() != ErrorCode::could_not_solve) throw;
      report.unseen_names.clear();
      report.notes.emplace_back(error.what());
    }
  }
  if (diagnosis.looked_again)
    report.notes.push_back("Searched with a sheet of " + std::to_string(o.triangles) +
                           " triangles; strengths and errors are those of one with twice as many.");
  for (int i = 0; i < static_cast<int>(model.objects().size()); ++i)
    if (const int crossings = crossings_of(model, i, diagnosis.extended.u, call.context); crossings > 0)
      report.notes.push_back(
          "Our simulation: the sheet of " + model.objects()[static_cast<std::size_t>(i)].name +
          " goes through itself (" + std::to_string(crossings) +
          " crossings), where a real one folds into a web. Errors beside webs are our simulation's.");
  if (in_order) {
    for (const FormedObject& part : *options.good_parts) report.good_parts.push_back(part.name);
    std::string names;
    for (const std::string& name : report.good_parts) names += (names.empty() ? "" : ", ") + name;
    report.notes.push_back("What the simulation misses of the good part " + names + ", " +
                           with_digits(in_order->error_mm, 2) +
                           " mm on average with noise, was added to what it predicts.");
  }
  for (const FormedObject& object : model.objects())
    for (const std::string& note : object.setup.notes) report.notes.push_back(object.name + ": " + note);

  // A cause that does not explain the data is not the machine's.
  const bool known = diagnosis.reading != Reading::unknown;
  MachineProfile profile = model.profile_at(known ? diagnosis.extended.u : diagnosis.base.u);
  if (profile.name.empty()) profile.name = "Diagnosed machine";
  profile.notes.push_back(verdict_sentence(report));

  OperationResult result = diagnosis_result(call, report);
  const auto add = [&](const char* name, const std::string& text) {
    for (const OutputInfo& info : evidence_diagnose_outputs())
      if (info.name == name && call.wants(name)) result.outputs.push_back(make_output(info, to_bytes(text)));
  };
  add("profile.json", write_machine_profile(profile));
  add("residuals.csv", residuals_csv(model, diagnosis, other.get(), predicted));
  if (const std::string text = thickness_csv(model, diagnosis, other.get(), predicted); !text.empty())
    add("thickness.csv", text);
  return result;
}

}  // namespace

Operation evidence_diagnose_operation() {
  Operation operation;
  operation.name = "evidence-diagnose";
  operation.title = "Diagnose";
  operation.summary =
      "Finds what causes measured objects to differ from the simulation, and measures how much the error shrinks once that is included.";
  operation.inputs = {
      object_input_info("object", "Measured object", "A folder with mould.obj, setup.json and measured.csv.", true,
                        true),
      object_input_info(
          "unseen", "Validation object",
          "Another folder of the same kind for validation: it is not used for fitting, only to measure the gain.",
          false, true),
      object_input_info(
          "good", "Good part",
          "Another folder of the same kind, over the same mould, from when the machine was in order. What the simulation misses of it is not blamed on anything: what has changed since is looked for.",
          false, true),
      profile_input_info()};
  operation.outputs = evidence_diagnose_outputs();
  operation.report = diagnosis_report_fields();
  operation.keeps_results = true;
  take_options<DiagnoseOptions>(operation, run_evidence_diagnose);
  return operation;
}

}  // namespace formwright
