// SPDX-License-Identifier: GPL-3.0-or-later
#include "jobs/solver_limits.h"

#include <fcntl.h>
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "base/format.h"
#include "base/error.h"
#include "jobs/solver_sandbox.h"

namespace formwright {
namespace {

constexpr rlim_t max_file_bytes = rlim_t{16} << 30;
constexpr int niceness = 10;
// The system ends the process with the highest score first when memory runs out (proc(5), oom_score_adj): the solver
// long before the worker that drives machines, but after a program that takes twice as much.
constexpr const char* memory_score = "500";
constexpr std::uint64_t min_memory_mb = 128;
constexpr const char *memory_flag = "--solver-memory-mb", *time_flag = "--max-job-minutes",
                     *no_sandbox_flag = "--no-solver-sandbox";

// Address sanitizers reserve terabytes of addresses, and their reports need calls that the filter forbids.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool instrumented = true;
#else
constexpr bool instrumented = false;
#endif

double number_of(const std::string& flag, const std::string& text, double minimum, double maximum) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !(number >= minimum && number <= maximum)) {
    throw Error(ErrorCode::invalid_input, flag,
                flag + " must be a number from " + with_digits(minimum, 6) + " to " + with_digits(maximum, 6) + ".");
  }
  return number;
}

/// The memory of this computer, or of the container that holds this process.
std::uint64_t memory_bytes() {
  std::uint64_t bytes =
      static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(::sysconf(_SC_PAGE_SIZE));
  for (const char* limit : {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"}) {
    std::ifstream file(limit);
    std::uint64_t allowed = 0;
    if (file >> allowed && allowed > 0) bytes = std::min(bytes, allowed);  // "max" is no number
  }
  return bytes;
}

void set_limit(decltype(RLIMIT_AS) what, rlim_t value) {
  rlimit now{};
  if (::getrlimit(what, &now) != 0) return;
  now.rlim_cur = now.rlim_max = std::min(value, now.rlim_max);
  ::setrlimit(what, &now);
}

}  // namespace

std::vector<FlagRule> solver_flag_rules() {
  return {{memory_flag}, {time_flag}, {no_sandbox_flag, FlagRule::Value::none}};
}

void set_solver_flags(const FlagValues& flags, SolverOptions& options) {
  if (const auto given = flags.find(memory_flag); given != flags.end())
    options.memory_mb = static_cast<std::uint64_t>(number_of(memory_flag, given->second.back(), min_memory_mb, 1e8));
  if (const auto given = flags.find(time_flag); given != flags.end())
    options.max_job_minutes = number_of(time_flag, given->second.back(), 0.01, 1e6);
  if (flags.contains(no_sandbox_flag)) options.sandbox = false;
}

std::vector<std::string> solver_words(const SolverOptions& options) {
  std::vector<std::string> words{"run-jobs",
                                 "--data",
                                 options.data.string(),
                                 time_flag,
                                 with_digits(options.max_job_minutes, 17),
                                 memory_flag,
                                 std::to_string(solver_memory_mb(options))};
  if (!options.sandbox) words.push_back(no_sandbox_flag);
  return words;
}

SolverOptions read_solver_words(const std::vector<std::string>& words) {
  std::vector<FlagRule> rules = solver_flag_rules();
  rules.push_back({"--data"});
  const FlagValues flags =
      read_flags(words, rules, [](const std::string& word) { return "There is no flag " + word + " of run-jobs."; });
  SolverOptions options;
  set_solver_flags(flags, options);
  if (const auto data = flags.find("--data"); data != flags.end()) options.data = data->second.back();
  return options;
}

std::uint64_t solver_memory_mb(const SolverOptions& options) {
  return options.memory_mb > 0 ? options.memory_mb : std::max(min_memory_mb, (memory_bytes() / 4 * 3) >> 20);
}

std::string describe_solver_limits(const SolverOptions& options) {
  std::string has, lacks;
  const auto put = [](std::string& list, const std::string& what) { list += (list.empty() ? "" : ", ") + what; };
  put(instrumented ? lacks : has, "memory limit " + std::to_string(solver_memory_mb(options)) + " MB");
  const int version = options.sandbox ? landlock_version() : 0;
  if (version > 0) put(has, "Landlock " + std::to_string(version));
  else put(lacks, "Landlock");
  const bool filters = options.sandbox && !instrumented && system_call_filter_available();
  put(filters ? has : lacks, "system call filter");
  put(has, job_time_text(options) + " a job");
  if (!lacks.empty()) put(has, (options.sandbox ? "not available: " : "switched off: ") + lacks);
  return "solver sandbox: " + has;
}

void limit_solver(const SolverOptions& options) {
  set_limit(RLIMIT_CORE, 0);
  set_limit(RLIMIT_FSIZE, max_file_bytes);
  std::signal(SIGXFSZ, SIG_IGN);  // the write fails instead, and the job says so
  if (!instrumented) set_limit(RLIMIT_AS, rlim_t{solver_memory_mb(options)} << 20);
  if (const int score = ::open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC); score >= 0) {
    if (::write(score, memory_score, 3) != 3) {
      // A container may forbid it: the system chooses by size alone then.
    }
    ::close(score);
  }
  ::setpriority(PRIO_PROCESS, 0, niceness);
  const sched_param ordinary{};
  ::sched_setscheduler(0, SCHED_BATCH, &ordinary);  // does not interrupt those who wake up
  if (!options.sandbox) return;
  if (!options.data.empty()) {
    FileAccess access{system_files(), {options.data / "jobs", options.data / "results"}};
    access.read.push_back(options.data / "blobs");
    std::error_code status;
    std::filesystem::create_directories(options.data / "results", status);
    if (landlock_version() > 0 && !restrict_files(access))
      std::fprintf(stderr, "formwright: the solver could not be restricted to its files (Landlock).\n");
  }
  if (!instrumented && system_call_filter_available() && !filter_system_calls())
    std::fprintf(stderr, "formwright: the solver's system calls could not be filtered.\n");
}

void limit_job(const SolverOptions& options, const std::filesystem::path& outputs,
               const std::filesystem::path& results) {
  if (!options.sandbox || options.data.empty()) return;
  FileAccess access{system_files(), {outputs}};
  access.read.push_back(options.data / "blobs");
  if (!results.empty()) access.write.push_back(results);
  restrict_files(access);  // the process as a whole is restricted already
}

std::string job_time_text(const SolverOptions& options) {
  if (options.max_job_minutes >= 120) return with_digits(options.max_job_minutes / 60, 6) + " h";
  return with_digits(options.max_job_minutes, 6) + " min";
}

}  // namespace formwright
