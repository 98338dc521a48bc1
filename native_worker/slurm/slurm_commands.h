// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Slurm's own programs: sbatch, squeue, scancel. Started by lists of words, never by a shell.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace formwright {

/// What a program has printed, and how it ended.
struct ProgramAnswer {
  int status = -1;  // of its exit; -1 where it was ended by a signal or by us
  std::string output, errors;
};

/// Runs a program of PATH to its end, or ends it after `limit_s`. In a process group of its own: Ctrl+C is ours to
/// handle. Throws Error{invalid_input, "--engine"} where it cannot be started.
ProgramAnswer run_program(const std::vector<std::string>& words, double limit_s);

/// A job array in Slurm's queue.
struct SlurmArray {
  std::string name;     // unique, as squeue shows it
  std::string job;      // its number
  std::string cluster;  // where Slurm has several; else empty
};

/// sbatch --parsable prints "12" or "12;cluster".
std::optional<SlurmArray> read_submission(const std::string& output, const std::string& name);

struct QueuedTask {
  std::string state, node, reason;  // "RUNNING", "n1", "None"
};

/// Lines "state|node|reason"; others, such as the heading of a cluster, are left out.
std::vector<QueuedTask> read_queue(const std::string& output);

/// The last line of words that a program has printed, without its name before them: what went wrong.
std::string last_words(const std::string& output);

/// Submits `tasks` tasks that run `words`; `options` are sbatch's own. Throws Error{invalid_input, "--engine"} with
/// Slurm's own words where it refuses them.
SlurmArray submit_array(const std::string& name, std::size_t tasks, const std::vector<std::string>& options,
                        const std::filesystem::path& folder, const std::vector<std::string>& words);

/// Asks Slurm whether it would take a job with these options. Throws Error{invalid_input, "--engine"}.
void check_slurm(const std::vector<std::string>& options, const std::filesystem::path& script);

/// Tasks that wait or run; nothing where Slurm does not answer.
std::optional<std::vector<QueuedTask>> queued_tasks(const SlurmArray& array);

/// Ends what is left of them, waiting or running; arrays of one cluster, or none.
void cancel_arrays(const std::vector<SlurmArray>& arrays);

}  // namespace formwright
