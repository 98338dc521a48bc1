// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <string>
#include <vector>

namespace formwright {

/// formwright run-simulations --results DIR --tasks FILE [--task N]: makes one share of a task list and keeps each
/// result in the folder; what is there already is not made again. N is SLURM_ARRAY_TASK_ID where it is not given.
/// Returns the exit code: 0 when all results are there. Throws Error: invalid_input, cancelled.
int run_simulations(const std::vector<std::string>& words, const std::atomic<bool>& interrupted);

}  // namespace formwright
