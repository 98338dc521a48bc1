// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/models/thermoform/virtual_measurement.h"
#include "job/operations/evidence/evidence_operations.h"
#include "job/contract/file_pack.h"
#include "job/contract/model_input.h"
#include "job/contract/operation_options.h"
#include "job/operations/thermoform/thermoform_input.h"

namespace formwright {
namespace {

std::vector<OutputInfo> evidence_virtual_object_outputs() {
  return {{"mould.obj", "model/obj", "Mould", "The mould as it should stand in the machine.", true},
          {"setup.json", "application/json", "Set-up", "The settings of the machine, without its faults.", true},
          {"measured.csv", "text/csv", "Measured points",
           "The points measured by the virtual scan (format: docs/measured_data.md).", true},
          {"truth.json", "application/json", "Truth",
           "Every parameter of the virtual machine, including its faults. Open it after the diagnosis.", true},
          {"object.zip", "application/zip", "Measured object", "mould.obj, setup.json and measured.csv in one file.",
           false}};
}

std::vector<ReportField> evidence_virtual_object_report_fields() {
  return {{"points", "Measured points", "", "Number of measured points."},
          {"thickness_readings", "Thickness readings", "", "Number of places at which the thickness was measured."},
          {"triangles", "Triangles", "", "Number of triangles in the simulated sheet."},
          {"seconds_simulation", "Simulation", "s", "Time for the simulation; 0 if an earlier one was used again."},
          {"peak_memory_mb", "Peak memory", "MB", "Largest amount of memory that the process used."},
          {"notes", "Notes", "", "What to know about the result, as sentences."}};
}

OperationResult run_evidence_virtual_object(const OperationCall& call, const Json& given, const Json& measurement,
                                            const Json& scan) {
  const SimulationCall simulation = simulation_call(call, given);
  const auto effects = read_parameters<MeasurementEffects>(measurement);
  Simulated simulated;
  {
    const auto span = call.context.span(0, 0.95, "Forming the virtual sheet");
    simulated = simulate(call, simulation);
  }
  const ThermoformOptions& o = simulation.options;
  constexpr MeasuredSurface surface = MeasuredSurface::outer;  // what a scanner sees
  const auto own_scan = read_parameters<VirtualScan>(scan);
  const std::vector<MeasuredPoint> points = scan_virtually(simulated.result->sheet, o, surface, effects, own_scan);
  const std::vector<MeasuredThickness> thickness = gauge_virtually(simulated.result->sheet, o, effects, own_scan);
  Model mould;
  mould.mesh = simulated.mould.placement(simulated.mould.shape->mesh);
  const Bytes obj = write_model(mould, MeshFormat::obj, call.context);
  const Bytes setup = to_bytes(write_object_setup(o, surface).dump(1) + "\n"),
              measured = to_bytes(add_measured_thickness(write_measured_points(points), thickness));
  Json truth = write_parameters(o);
  truth.update(write_parameters(effects));

  OperationResult result;
  result.report["points"] = points.size();
  result.report["thickness_readings"] = thickness.size();
  result.report["triangles"] = simulated.result->sheet.mesh.face_count();
  result.report["seconds_simulation"] = simulated.reused ? 0.0 : simulated.result->seconds;
  result.report["notes"] = simulated.result->placement.notes;
  const auto add = [&](const char* name, Bytes bytes) {
    for (const OutputInfo& info : evidence_virtual_object_outputs())
      if (info.name == name && call.wants(name)) result.outputs.push_back(make_output(info, std::move(bytes)));
  };
  add("mould.obj", obj);
  add("setup.json", setup);
  add("measured.csv", measured);
  add("truth.json", to_bytes(truth.dump(1) + "\n"));
  if (call.wants("object.zip"))
    add("object.zip",
        pack_files({{"mould.obj", obj}, {"setup.json", setup}, {"measured.csv", measured}}, call.context));
  return result;
}

}  // namespace

Operation evidence_virtual_object_operation() {
  Operation operation;
  operation.name = "evidence-virtual-object";
  operation.title = "Make a virtual object";
  operation.summary =
      "Forms and measures an object on a simulated machine with faults that you choose, to practise a diagnosis.";
  operation.inputs = {mould_input_info()};
  operation.outputs = evidence_virtual_object_outputs();
  operation.report = evidence_virtual_object_report_fields();
  take_mergeable_options<ThermoformOptions, MeasurementEffects, VirtualScan>(operation, run_evidence_virtual_object);
  return operation;
}

}  // namespace formwright
