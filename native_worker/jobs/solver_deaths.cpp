// SPDX-License-Identifier: GPL-3.0-or-later
#include "jobs/solver_deaths.h"

#include <sys/wait.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <string>

#include "base/error.h"

namespace formwright {
namespace {

constexpr int max_crashes = 2;        // the same input crashes again
constexpr int max_out_of_memory = 2;  // the first time another program may have taken the memory
constexpr int max_kills = 20;         // says nothing of the job, unless it never ends otherwise
constexpr std::chrono::milliseconds first_pause{100}, max_pause{10000};

Json failure(ErrorCode code, const std::string& sentence) {
  return {{"error", {{"code", to_string(code)}, {"where", ""}, {"message", sentence}}}};
}

}  // namespace

SolverDeath death_of(int status, bool kernel_took_memory) {
  if (!WIFSIGNALED(status)) return SolverDeath::crashed;
  switch (WTERMSIG(status)) {
    case SIGKILL: return kernel_took_memory ? SolverDeath::out_of_memory : SolverDeath::killed;
    case SIGTERM:
    case SIGINT:
    case SIGHUP: return SolverDeath::ended;
    default: return SolverDeath::crashed;
  }
}

std::uint64_t oom_kills() {
  std::ifstream file("/proc/vmstat");
  std::string name;
  std::uint64_t value = 0;
  while (file >> name >> value)
    if (name == "oom_kill") return value;
  return 0;
}

void SolverDeaths::count(SolverDeath death) {
  if (death == SolverDeath::crashed) ++crashed;
  if (death == SolverDeath::out_of_memory) ++out_of_memory;
  if (death == SolverDeath::killed) ++killed;
}

std::optional<Json> SolverDeaths::verdict() const {
  if (crashed >= max_crashes)
    return failure(ErrorCode::internal,
                   "This job stopped the solver twice and is not tried again: simplify the model, and report it. "
                   "Nothing else is lost.");
  if (out_of_memory >= max_out_of_memory)
    return failure(ErrorCode::out_of_memory,
                   "The system stopped the solver process twice for lack of memory: use a smaller model. Nothing else "
                   "is lost.");
  if (killed >= max_kills)
    return failure(ErrorCode::out_of_memory,
                   "The solver process was killed " + std::to_string(killed) +
                       " times, most likely by the system for lack of memory: use a smaller model. Nothing else is "
                       "lost.");
  return std::nullopt;
}

std::chrono::milliseconds SolverDeaths::pause() const {
  const int deaths = std::clamp(crashed + out_of_memory + killed, 1, 10);
  return std::min(first_pause * (1 << (deaths - 1)), max_pause);
}

Json SolverDeaths::json() const { return {{"crashed", crashed}, {"out_of_memory", out_of_memory}}; }

SolverDeaths SolverDeaths::from_json(const Json& deaths) {
  return {deaths.at("crashed").get<int>(), deaths.at("out_of_memory").get<int>()};
}

}  // namespace formwright
