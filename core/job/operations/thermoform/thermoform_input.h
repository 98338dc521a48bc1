// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What the thermoforming operations share: the model as it stands in the machine, and the sheet formed over it,
// computed once a session or read from a file.
#include <memory>
#include <optional>
#include <string>

#include "job/contract/model_input.h"
#include "thermoform/forming.h"
#include "thermoform/machine_profile.h"
#include "thermoform/measured/measured_object.h"

namespace formwright {

struct FormedModel {
  std::shared_ptr<const LoadedModel> loaded;
  Placement placement;       // where the model should stand
  Placement real_placement;  // where it stands: the machine may displace it (sheet_effects.h)
  std::shared_ptr<const FormedSheet> sheet;
};

/// Declarations of the inputs "mould" (a model) and "sheet" (sheet.ply of thermoform-simulate, optional).
InputInfo mould_input_info();
InputInfo sheet_input_info();
/// Of the optional input "setup" (setup.json).
InputInfo setup_input_info();
/// Of the optional input "profile" (a machine profile).
InputInfo profile_input_info();

/// Reads "mould", places it, takes "sheet" when the call has it, or simulates (kept in the session).
FormedModel formed_model(const OperationCall& call, const ThermoformOptions& options);

/// The model in the machine and its search tree, without forming anything.
struct PlacedMould {
  std::shared_ptr<const LoadedModel> loaded;
  std::shared_ptr<const MouldShape> shape;
  Placement placement;
};
PlacedMould placed_mould(const OperationCall& call, const ThermoformOptions& options);

/// The call's "profile", when it has one.
std::optional<MachineProfile> machine_profile(const OperationCall& call);

/// `parameters`, those given by name, over the profile's and the set-up's (with_profile, machine_profile.h).
Json merged_parameters(const OperationCall& call, const Json& parameters,
                       const std::optional<ObjectSetup>& setup = std::nullopt);

/// The simulation's options, merged; a setup also means that the mould is in machine coordinates already.
struct SimulationCall {
  ThermoformOptions options;
  std::optional<ObjectSetup> setup;
};
SimulationCall simulation_call(const OperationCall& call, const Json& parameters);

struct Simulated {
  PlacedMould mould;
  std::shared_ptr<const FormedResult> result;
  bool reused = false;  // from an earlier job on the same model and parameters
};
Simulated simulate(const OperationCall& call, const SimulationCall& simulation);

/// Columns and triangles of sheet.ply; `shift_z_mm` is added to z.
Bytes write_sheet_ply(const FormedSheet& sheet, double shift_z_mm, Context& context);
FormedSheet read_sheet_ply(ByteView bytes, const std::string& file_name, Context& context);

}  // namespace formwright
