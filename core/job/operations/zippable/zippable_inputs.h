// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Inputs that operations on designed zippables share.
#include "job/contract/operation.h"
#include "zippable/making/making_profile.h"

namespace formwright {

/// The input "design": design.json.
InputInfo flat_design_info();

/// The optional input "profile": what a workshop is known to get wrong.
InputInfo making_profile_info();

/// The optional input "plan": plan.json, how pieces were turned on their sheets.
InputInfo plan_record_info();

/// `given`, and the profile's where they are not given. Throws Error{invalid_input, "profile"}.
Json with_making_profile(const OperationCall& call, const Json& given);

}  // namespace formwright
