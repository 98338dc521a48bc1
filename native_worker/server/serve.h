// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The native worker: docs/job_contract.md, "In the worker".
#include <string>
#include <vector>

namespace formwright {

/// `formwright serve [--port N] [--web DIR] [--data DIR]`. Returns the exit code once it is asked to stop.
int serve(const std::vector<std::string>& words);

}  // namespace formwright
