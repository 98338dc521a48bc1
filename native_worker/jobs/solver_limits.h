// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a solver process may take: memory, processor, files, time. Limits go with the process, so that nothing a job
// does reaches the worker and the machines it drives.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "command_line/flags.h"

namespace formwright {

struct SolverOptions {
  std::filesystem::path data;   // where blobs, jobs and results are kept; empty: files are not restricted
  std::uint64_t memory_mb = 0;  // of address space; 0: three quarters of this computer's memory
  double max_job_minutes = 24 * 60;
  bool sandbox = true;  // Landlock and the filter of system calls
};

/// The flags of solvers: --solver-memory-mb N, --max-job-minutes N and --no-solver-sandbox.
std::vector<FlagRule> solver_flag_rules();
/// Throws Error{invalid_input} naming the flag whose value is out of range.
void set_solver_flags(const FlagValues& flags, SolverOptions& options);

/// The command line of the solver process behind the program's name.
std::vector<std::string> solver_words(const SolverOptions& options);
/// What `solver_words` made.
SolverOptions read_solver_words(const std::vector<std::string>& words);

std::uint64_t solver_memory_mb(const SolverOptions& options);

/// "solver sandbox: memory limit 12 GB, Landlock 7, system call filter", and what this computer does not have.
std::string describe_solver_limits(const SolverOptions& options);

/// For the solver process, before it starts a thread. What the system refuses is said on standard error.
void limit_solver(const SolverOptions& options);

/// Restricts the calling thread, and those it starts, to one job: its outputs and the intermediate results.
void limit_job(const SolverOptions& options, const std::filesystem::path& outputs,
               const std::filesystem::path& results);

/// "24 h" or "90 min".
std::string job_time_text(const SolverOptions& options);

}  // namespace formwright
