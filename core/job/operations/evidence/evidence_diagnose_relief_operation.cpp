// SPDX-License-Identifier: GPL-3.0-or-later
#include <optional>

#include "evidence/diagnosis/unseen.h"
#include "evidence/models/relief/relief_model.h"
#include "formats/mesh_io.h"
#include "job/contract/operation_options.h"
#include "job/operations/evidence/diagnosis_result.h"
#include "job/operations/evidence/evidence_input.h"
#include "job/operations/evidence/evidence_operations.h"
#include "job/contract/file_pack.h"

namespace formwright {
namespace {

struct DiagnoseReliefOptions {
  bool pairs = true;
  int pixels = 240;

  static constexpr auto parameters = std::tuple{
      parameter("pairs", &DiagnoseReliefOptions::pairs, "Two causes at once",
                "Also looks for two causes acting together. Takes longer; switch it off for a quick look.")
          .group("Diagnosis"),
      parameter(
          "pixels", &DiagnoseReliefOptions::pixels, "Pixels", unit::none, 50, 1000,
          "Number of height samples along the longer side of the relief. More resolve finer detail and take longer.")
          .group("Diagnosis")
          .advanced()};
};

const std::vector<std::string> files_of_relief{"relief.obj", "setup.json", "shading.csv"};
const std::vector<std::string> more_files_of_relief{"base.obj"};

std::vector<PhotographedRelief> read_reliefs(const OperationCall& call, const std::string& name, int pixels) {
  std::vector<PhotographedRelief> reliefs;
  for (const auto& [own, input] : inputs_named(call, name)) {
    const std::map<std::string, Bytes> files =
        unpack_files(*input, own, files_of_relief, call.context, more_files_of_relief);
    PhotographedRelief relief;
    relief.name = pack_name(*input, own);
    try {
      relief.points = read_shaded_points(files.at("shading.csv"));
      relief.setup = read_shading_setup(files.at("setup.json"));
      ReadOptions options;
      options.where = own;
      const auto mesh = [&](const std::string& file) {
        return read_model_file(files.at(file), file, options, call.context).model.mesh;
      };
      std::optional<TriangleMesh> base;
      if (files.contains("base.obj")) base = mesh("base.obj");
      relief.surface = ReliefSurface::of(mesh("relief.obj"), base ? &*base : nullptr, pixels, own, call.context);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::invalid_input) throw;
      throw Error(error.code(), own, relief.name + ": " + error.what());
    }
    reliefs.push_back(std::move(relief));
  }
  return reliefs;
}

OperationResult run_evidence_diagnose_relief(const OperationCall& call, const DiagnoseReliefOptions& o) {
  require_each_once(call, "shading.csv");
  std::vector<PhotographedRelief> unseen = read_reliefs(call, "unseen", o.pixels);
  const ReliefModel model(read_reliefs(call, "object", o.pixels));
  SimulationBag bag(model);
  DiagnosisOptions options;
  options.pairs = o.pairs;
  Diagnosis diagnosis;
  {
    const auto span = call.context.span(0, 0.95, "Diagnosing");
    diagnosis = diagnose(bag, options, call.context);
  }
  DiagnosisReport report{model, diagnosis, {}, std::nullopt, {}, {}, ""};
  for (const NotSeparable& pair : diagnosis.not_separable) report.separations.push_back({pair, "", pair.similarity});
  if (!unseen.empty()) {
    for (const PhotographedRelief& relief : unseen) report.unseen_names.push_back(relief.name);
    const ReliefModel other(std::move(unseen));
    report.unseen = predict_unseen(other, model, diagnosis, call.context).gain;
  }
  report.notes.emplace_back(
      "Brightness is measured as a fraction of each picture's brightest point. Every picture has an exposure of its own.");
  if (model.points_beside() > 0)
    report.notes.push_back("Points beside the relief are left out: " + std::to_string(model.points_beside()) + ".");
  return diagnosis_result(call, report);
}

InputInfo relief_input_info(const std::string& name, const std::string& label, const std::string& help, bool required) {
  InputInfo info = object_input_info(name, label, help, required, true);
  info.folder_files = files_of_relief;
  info.optional_folder_files = more_files_of_relief;
  return info;
}

}  // namespace

Operation evidence_diagnose_relief_operation() {
  Operation operation;
  operation.name = "evidence-diagnose-relief";
  operation.title = "Diagnose a relief";
  operation.summary = "Finds why a finished relief does not look as it should, from photographs of it in known light.";
  operation.inputs = {
      relief_input_info(
          "object", "Photographed relief",
          "A folder with relief.obj, setup.json and shading.csv; more pictures in folders of their own. base.obj, the surface that the relief was worked into, is optional: depth counts from there.",
          true),
      relief_input_info(
          "unseen", "Validation relief",
          "Another folder of the same kind for validation: it is not used for fitting, only to measure the gain.",
          false)};
  operation.outputs = diagnosis_outputs();
  operation.report = diagnosis_report_fields();
  take_options<DiagnoseReliefOptions>(operation, run_evidence_diagnose_relief);
  return operation;
}

}  // namespace formwright
