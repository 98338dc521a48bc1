// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What it means for a job that its solver process ended by itself, while the worker lived and had not asked for it.
// The end of the worker, which takes the solver with it, is never counted.
#include <chrono>
#include <cstdint>
#include <optional>

#include "base/data/json.h"

namespace formwright {

enum class SolverDeath {
  crashed,        // a signal of its own doing (SIGSEGV, SIGABRT, ...), or an exit
  out_of_memory,  // the kernel ended it to get memory back
  killed,         // SIGKILL by somebody
  ended           // SIGTERM, SIGINT or SIGHUP: most likely sent to the worker, too
};

/// `status` as from waitpid(2). `kernel_took_memory`: oom_kills() rose while the solver worked.
SolverDeath death_of(int status, bool kernel_took_memory);

/// How often the kernel has ended a process for memory since it started (/proc/vmstat); 0 where it does not say.
std::uint64_t oom_kills();

/// Of one job.
struct SolverDeaths {
  int crashed = 0, out_of_memory = 0;
  int killed = 0;  // since the worker started: whoever kills that, too, says nothing of the job

  void count(SolverDeath death);
  /// {"error"} with which the job fails for good, or nothing: it starts again.
  std::optional<Json> verdict() const;
  /// Before it starts again: doubles with every death, so that a job that ends its solver at once leaves time for
  /// others.
  std::chrono::milliseconds pause() const;

  Json json() const;  // what the next worker is to know
  static SolverDeaths from_json(const Json& deaths);
};

}  // namespace formwright
