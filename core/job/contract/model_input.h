// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The input that most operations share: a model from a file or a sample, read and repaired once a session.
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "formats/mesh_io.h"
#include "job/contract/model_columns.h"
#include "job/contract/operation.h"

namespace formwright {

struct LoadedModel {
  Model model;                                  // repaired
  ModelColumns columns;                         // of its vertices
  std::vector<std::string> repairs;             // sentences
  std::string file_format;                      // "obj", ...; "sample" for one of ours
  double seconds_read = 0, seconds_repair = 0;  // of the first time; 0 when found in the session
  std::string key;
  std::string name;  // what a person calls it: its file
};

/// Declaration of the input called "mesh".
InputInfo model_input_info();

/// Reads and repairs, or finds it in the session.
std::shared_ptr<const LoadedModel> load_model(const OperationCall& call, const std::string& input_name = "mesh");

OutputBlob make_output(const OutputInfo& info, Bytes bytes);

/// One output a format, "<stem>.<extension>"; the one of `made_by_default` without being asked for.
std::vector<OutputInfo> mesh_outputs(const std::string& stem, MeshFormat made_by_default);
/// Those of them that the call wants. `columns`: of the model's vertices, for formats that hold them.
std::vector<OutputBlob> write_mesh_outputs(const OperationCall& call, const std::vector<OutputInfo>& outputs,
                                           const Model& model, std::span<const VertexColumn> columns = {});

}  // namespace formwright
