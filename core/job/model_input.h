// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The input that most operations share: a model from a file or a sample, read and repaired once a session.
#include <memory>
#include <string>
#include <vector>

#include "geometry/io/mesh_io.h"
#include "job/operation.h"

namespace formwright {

struct LoadedModel {
  Model model;                          // repaired
  std::vector<std::string> repairs;     // sentences
  std::string file_format;              // "obj", ...; "sample" for one of ours
  double seconds_read = 0, seconds_repair = 0;  // of the first time; 0 when found in the session
  std::string key;
};

/// Declaration of the input called "mesh".
InputInfo model_input_info();

/// Reads and repairs, or finds it in the session.
std::shared_ptr<const LoadedModel> load_model(const OperationCall& call, const std::string& input_name = "mesh");

/// Helpers for outputs.
OutputBlob make_output(const Operation& operation, const std::string& name, Bytes bytes);
OutputBlob make_output(const OutputInfo& info, Bytes bytes);

/// Formats in which every mesh output can be asked for, "<stem>.<extension>".
std::vector<OutputInfo> mesh_outputs(const std::string& stem, const std::string& default_extension);

}  // namespace formwright
