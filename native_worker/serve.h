// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The native worker: docs/job_contract.md, "In the worker".
#include <string>
#include <vector>

namespace formwright {

/// `formwright serve [--port N] [--web DIR] [--data DIR]`. Returns the exit code once it is asked to stop.
int serve(const std::vector<std::string>& words);

/// `formwright run-jobs`: the child process in which jobs run; speaks to its server over standard input and output.
/// `words`: of solver_words() (solver_limits.h), behind the first.
int run_jobs_for_server(const std::vector<std::string>& words);

}  // namespace formwright
