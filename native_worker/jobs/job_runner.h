// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

namespace formwright {

/// `formwright run-jobs`: the child process in which jobs run; speaks to its server over standard input and output.
/// `words`: of solver_words() (solver_limits.h), behind the first.
int run_jobs_for_server(const std::vector<std::string>& words);

}  // namespace formwright
