// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdio>

#include "evidence/diagnosis/unseen.h"
#include "evidence/models/zippable/zippable_proposals.h"
#include "job/contract/file_pack.h"
#include "job/contract/model_input.h"
#include "job/contract/operation_options.h"
#include "job/operations/evidence/diagnosis_result.h"
#include "job/operations/evidence/evidence_input.h"
#include "job/operations/evidence/evidence_operations.h"

namespace formwright {
namespace {

struct DiagnoseZippableOptions {
  bool pairs = true;

  static constexpr auto parameters =
      std::tuple{parameter("pairs", &DiagnoseZippableOptions::pairs, "Two causes at once",
                           "Also looks for two causes acting together. Takes longer; switch it off for a quick look.")
                     .group("Diagnosis")};
};

const std::vector<std::string> files_of_zippable{"design.json"};
const std::vector<std::string> more_files_of_zippable{"plan.json", "setup.json", "lengths.csv", "scan.ply",
                                                      "scan.obj",  "scan.stl",   "scan.glb"};

std::vector<MeasuredZippable> read_zippables(const OperationCall& call, const std::string& name) {
  std::vector<MeasuredZippable> objects;
  for (const auto& [own, input] : inputs_named(call, name)) {
    const std::map<std::string, Bytes> files =
        unpack_files(*input, own, files_of_zippable, call.context, more_files_of_zippable);
    const std::string title = pack_name(*input, own);
    try {
      objects.push_back(read_measured_zippable(title, files, call.context));
    } catch (const Error& error) {
      if (error.code() != ErrorCode::invalid_input) throw;
      throw Error(error.code(), own, title + ": " + error.what());
    }
  }
  return objects;
}

std::vector<OutputInfo> diagnose_zippable_outputs() {
  std::vector<OutputInfo> outputs = diagnosis_outputs();
  outputs.push_back({"profile.json", "application/json", "Making profile",
                     "What goes wrong when a plan is cut and sewn: zippable-plan makes up for it.", true});
  outputs.push_back({"lengths.csv", "text/csv", "Lengths",
                     "Every measured length beside both simulations. Only where lengths were measured.", true});
  return outputs;
}

/// Empty where only scans were made.
std::string lengths_csv(const ZippableModel& model, const Diagnosis& d) {
  std::string text;
  std::size_t m = 0;
  for (const MeasuredZippable& object : model.objects()) {
    if (!object.lengths.empty()) {
      for (std::size_t i = 0; i < object.lengths.size(); ++i) {
        const MeasuredLength& length = object.lengths[i];
        const auto row = static_cast<Eigen::Index>(i);
        char numbers[160];
        std::snprintf(numbers, sizeof numbers, ",%.6g,%.4g,%.6g,%.6g\n", length.length_mm, length.sigma_mm,
                      d.base.predictions[m](row, 0), d.extended.predictions[m](row, 0));
        text += table_name(object.name) + "," + mark_text(length.from, length.flat) + "," +
                mark_text(length.to, length.flat) + "," + (length.flat ? "flat" : "zipped") + numbers;
      }
      ++m;
    }
    if (object.scan_mm.rows() > 0) ++m;
  }
  return text.empty() ? text : "object,from,to,state,length_mm,sigma_mm,calibrated_mm,extended_mm\n" + text;
}

OperationResult run_evidence_diagnose_zippable(const OperationCall& call, const DiagnoseZippableOptions& o) {
  std::vector<MeasuredZippable> unseen, objects;
  {
    const auto span = call.context.span(0, 0.01, "Reading the objects");
    unseen = read_zippables(call, "unseen");
    objects = read_zippables(call, "object");
  }
  std::unique_ptr<const ZippableModel> model, other;
  {
    const auto span = call.context.span(0.01, 0.05, "Simulating the zipped shape");
    model = std::make_unique<const ZippableModel>(std::move(objects), call.context);
  }
  if (!unseen.empty()) {
    const auto span = call.context.span(0.05, 0.08, "Simulating the validation object");
    other = std::make_unique<const ZippableModel>(std::move(unseen), call.context, TuckedLimbs::are_left_out);
  }
  SimulationBag bag(*model);
  Diagnosis diagnosis;
  {
    const auto span = call.context.span(0.08, 0.9, "Diagnosing");
    DiagnosisOptions options;
    options.pairs = o.pairs;
    diagnosis = diagnose(bag, options, call.context);
  }
  DiagnosisReport report{*model, diagnosis, {}, std::nullopt, {}, {}};
  if (!diagnosis.not_separable.empty()) {
    const auto span = call.context.span(0.9, 0.97, "Looking for a measurement that distinguishes them");
    report.separations = separated_pairs(bag, diagnosis, proposed_measurements(*model, call.context), call.context);
  }
  if (other) {
    for (const MeasuredZippable& object : other->objects()) report.unseen_names.push_back(object.name);
    report.unseen = predict_unseen(*other, *model, diagnosis, call.context).gain;
  }
  const bool known = diagnosis.reading != Reading::unknown;
  MakingProfile profile = model->profile_at(known ? diagnosis.extended.u : diagnosis.base.u);
  profile.name = "Diagnosed workshop";
  profile.notes.push_back(verdict_sentence(report));
  OperationResult result = diagnosis_result(call, report);
  const auto add = [&](const char* name, const std::string& text) {
    for (const OutputInfo& info : diagnose_zippable_outputs())
      if (info.name == name && call.wants(name)) result.outputs.push_back(make_output(info, to_bytes(text)));
  };
  add("profile.json", write_making_profile(profile));
  if (const std::string text = lengths_csv(*model, diagnosis); !text.empty()) add("lengths.csv", text);
  return result;
}

InputInfo zippable_folder_info(const std::string& name, const std::string& label, const std::string& help,
                               bool required) {
  InputInfo info = object_input_info(name, label, help, required, true);
  info.folder_files = files_of_zippable;
  info.optional_folder_files = more_files_of_zippable;
  return info;
}

}  // namespace

Operation evidence_diagnose_zippable_operation() {
  Operation operation;
  operation.name = "evidence-diagnose-zippable";
  operation.title = "Diagnose a zippable";
  operation.summary =
      "Finds why a zipped object is not as designed, from lengths between its marks or a scan, and what the next plan has to make up for.";
  operation.inputs = {
      zippable_folder_info(
          "object", "Measured zippable",
          "A folder with design.json and lengths.csv, a scan (scan.ply, scan.obj, scan.stl or scan.glb), or both; plan.json and setup.json where there are any.",
          true),
      zippable_folder_info(
          "unseen", "Validation zippable",
          "Another folder of the same kind for validation: it is not used for fitting, only to measure the gain.",
          false)};
  operation.outputs = diagnose_zippable_outputs();
  operation.report = diagnosis_report_fields();
  take_options<DiagnoseZippableOptions>(operation, run_evidence_diagnose_zippable);
  return operation;
}

}  // namespace formwright
