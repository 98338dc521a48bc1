// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What the evidence operations share: measured objects and machine profiles as inputs, findings as JSON.
#include "evidence/calibration.h"
#include "evidence/diagnosis/diagnosis.h"
#include "evidence/models/thermoform/thermoform_model.h"
#include "job/contract/operation.h"

namespace formwright {

/// A measured object's folder (docs/measured_data.md), packed.
InputInfo object_input_info(const std::string& name, const std::string& label, const std::string& help, bool required,
                            bool repeatable);

/// All inputs `name`, `name`_2, ... in order; empty where there is none. Throws Error{invalid_input, name} saying what
/// is wrong with which.
std::vector<FormedObject> read_formed_objects(const OperationCall& call, const std::string& name);

/// Throws Error{invalid_input} where two of the inputs "object", "unseen" and "good" hold the same measurement, the
/// pack's `file`: it would count double, or the gain be measured on what was fitted.
void require_each_once(const OperationCall& call, const std::string& file);

/// The input "profile", or an empty profile.
MachineProfile read_profile_input(const OperationCall& call);

/// {name, value, unit} of every parameter of a role.
Json parameter_values(const ForwardModel& model, const Eigen::VectorXd& u, ParameterRole role);

}  // namespace formwright
