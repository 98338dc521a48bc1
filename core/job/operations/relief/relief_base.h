// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The base of a relief as a job asks for it: a built-in shape, or a file of its own.
#include <memory>

#include "job/contract/model_input.h"
#include "relief/base/base_surface.h"
#include "relief/view/relief_options.h"

namespace formwright {

/// Declaration of the input called "base_mesh".
InputInfo base_input_info();

/// The file's model, null without one. Throws Error{invalid_input}: a file beside a built-in shape, a file that is no
/// model.
std::shared_ptr<const LoadedModel> load_base(const OperationCall& call, const ReliefOptions& options);

/// In view coordinates; `file` as load_base has it. Throws Error{invalid_input}: see base_shape, base_from_file and
/// BaseParts.
BaseSurface relief_base(const LoadedModel* file, const ReliefOptions& options, const ViewFrame& frame,
                        Context& context);

}  // namespace formwright
