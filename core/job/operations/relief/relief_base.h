// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The base of a relief as a job asks for it: a built-in shape, or a file of its own.
#include "job/contract/operation.h"
#include "relief/base/base_surface.h"
#include "relief/view/relief_options.h"

namespace formwright {

/// Declaration of the input called "base_mesh".
InputInfo base_input_info();

/// In view coordinates. Throws Error{invalid_input}: a file beside a built-in shape, see base_shape and base_from_file.
BaseSurface relief_base(const OperationCall& call, const ReliefOptions& options, const ViewFrame& frame);

}  // namespace formwright
