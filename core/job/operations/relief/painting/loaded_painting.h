// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The painting that a job asks for: in the model's own file, or beside it.
#include <string>
#include <vector>

#include "job/contract/model_input.h"
#include "relief/painting/painting.h"

namespace formwright {

/// Declarations of the inputs called "painting" and "painted_mesh".
InputInfo painting_input_info();
InputInfo painted_mesh_input_info();

struct LoadedPainting {
  Painting painting;               // of the repaired model's vertices
  std::vector<std::string> notes;  // what to know about it
};

/// The input "painting" where there is one, else the numbers of the model's own vertices (painting_file.h). With
/// "painted_mesh" the painting is that model's, and every vertex of `model` takes the values of the vertex nearest to
/// it on the surface. Throws Error{invalid_input}: see read_painting; a painted model that is not the same shape; a
/// painted model without a painting.
LoadedPainting load_painting(const OperationCall& call, const LoadedModel& model);

}  // namespace formwright
