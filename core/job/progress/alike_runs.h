// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Which runs of an operation spend their time alike.
#include <string>

#include "job/contract/operation.h"

namespace formwright {

/// The operation's name, and behind it the switches and choices among `parameters` that are not as usual:
/// "evidence-diagnose pairs=false". Sizes are left out: they change how long all parts take together. Never throws;
/// values of a wrong kind count as usual.
std::string alike_runs(const Operation& operation, const Json& parameters);

}  // namespace formwright
