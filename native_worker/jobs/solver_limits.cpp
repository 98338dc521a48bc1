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

bool read_solver_flag(const std::vector<std::string>& words, std::size_t& i, SolverOptions& options) {
  const std::string flag = words[i];
  if (flag == "--no-solver-sandbox") {
    options.sandbox = false;
    return true;
  }
  if (flag != "--solver-memory-mb" && flag != "--max-job-minutes") return false;
  if (i + 1 >= words.size()) throw Error(ErrorCode::invalid_input, flag, flag + " needs a value.");
  const std::string value = words[++i];
  if (flag == "--max-job-minutes") options.max_job_minutes = number_of(flag, value, 0.01, 1e6);
  else options.memory_mb = static_cast<std::uint64_t>(number_of(flag, value, min_memory_mb, 1e8));
  return true;
}

std::vector<std::string> solver_words(const SolverOptions& options) {
  std::vector<std::string> words{"run-jobs",
                                 "--data",
                                 options.data.string(),
                                 "--max-job-minutes",
                                 with_digits(options.max_job_minutes, 17),
                                 "--solver-memory-mb",
                                 std::to_string(solver_memory_mb(options))};
  if (!options.sandbox) words.push_back("--no-solver-sandbox");
  return words;
}

SolverOptions read_solver_words(const std::vector<std::string>& words) {
  SolverOptions options;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (read_solver_flag(words, i, options)) continue;
    if (words[i] != "--data" || i + 1 >= words.size())
      throw Error(ErrorCode::invalid_input, words[i], "There is no flag " + words[i] + " of run-jobs.");
    options.data = words[++i];
  }
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
