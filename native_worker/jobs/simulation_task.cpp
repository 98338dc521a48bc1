// SPDX-License-Identifier: GPL-3.0-or-later
#include "jobs/simulation_task.h"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <new>

#include "base/error.h"
#include "command_line/flags.h"
#include "job/make_result.h"
#include "slurm/finished_tasks.h"
#include "slurm/task_list.h"
#include "system/files.h"
#include "system/host.h"

namespace formwright {
namespace {

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

std::size_t share_index(const std::string& text) {
  constexpr std::size_t max_digits = 9;
  if (text.empty() || text.size() > max_digits || text.find_first_not_of("0123456789") != std::string::npos)
    throw Error(ErrorCode::invalid_input, "--task",
                "--task must be the number of a share, and is \"" + text + "\": Slurm says it in SLURM_ARRAY_TASK_ID.");
  return static_cast<std::size_t>(std::stoul(text));
}

}  // namespace

int run_simulations(const std::vector<std::string>& words, const std::atomic<bool>& interrupted) {
  const FlagValues flags = read_flags(words, {{"--results"}, {"--tasks"}, {"--task"}}, [](const std::string& word) {
    return "There is no flag " + word + " of run-simulations: it has --results, --tasks and --task.";
  });
  const auto value_of = [&](const char* flag) {
    const auto found = flags.find(flag);
    if (found == flags.end())
      throw Error(ErrorCode::invalid_input, flag, std::string("run-simulations needs ") + flag + ".");
    return found->second.back();
  };
  const std::string index = flags.contains("--task") ? value_of("--task") : environment("SLURM_ARRAY_TASK_ID");
  const std::filesystem::path file = value_of("--tasks");
  const ResultFolder results{value_of("--results")};
  const std::size_t share = share_index(index);
  const std::string slurm_node = environment("SLURMD_NODENAME");
  const std::string node = slurm_node.empty() ? machine_name() : slurm_node;
  const Host host{{}, [&interrupted] { return interrupted.load(); }, peak_memory_mb};
  bool all_made = true;
  for (const ListedTask& task : read_share(file, share)) {
    if (interrupted) throw Error(ErrorCode::cancelled, "", "Cancelled.");
    if (results.find(task.key)) continue;
    const Stopwatch watch;
    try {
      const auto input = results.find(task.input_key);
      if (!input)
        throw Error(ErrorCode::invalid_input, "--results",
                    value_of("--results") + " has no file " + task.input_key + ": start the job again.");
      results.keep(task.key, make_result(task.key, task.recipe, *input, host));
      if (!results.find(task.key))
        throw Error(ErrorCode::invalid_input, "--results",
                    value_of("--results") + " cannot be written on " + node + ": check its permissions and its space.");
      note_finished(file.parent_path() / ("finished-" + std::to_string(share)), {task.key, node, watch.seconds()});
    } catch (const Error& error) {
      if (error.code() == ErrorCode::cancelled) throw;
      std::fprintf(stderr, "formwright: %s\n", error.what());
      all_made = false;
    } catch (const std::bad_alloc&) {
      std::fprintf(stderr, "formwright: A simulation needs more memory than %s gives: use --slurm-option --mem=4G.\n",
                   node.c_str());
      all_made = false;
    }
  }
  return all_made ? 0 : 3;
}

}  // namespace formwright
