// SPDX-License-Identifier: GPL-3.0-or-later
// After Slurm's manual pages: sbatch(1), squeue(1), scancel(1).
#include "slurm/slurm_commands.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <utility>

#include "base/error.h"

namespace formwright {
namespace {

constexpr double limit_of_program_s = 120;  // Slurm's programs themselves give up a silent controller after 10 to 20 s

[[noreturn]] void refuse(const std::string& sentence) {
  throw Error(ErrorCode::invalid_input, "--engine", "--engine slurm: " + sentence);
}

struct Pipe {
  int ends[2] = {-1, -1};
  Pipe() {
    if (::pipe2(ends, O_CLOEXEC) != 0) refuse("the system has no room for another process.");
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
  void close_end(int end) {
    if (ends[end] >= 0) ::close(ends[end]);
    ends[end] = -1;
  }
};

pid_t start(const std::vector<std::string>& words, const Pipe& output, const Pipe& errors) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&files, output.ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files, errors.ends[1], STDERR_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  posix_spawnattr_setpgroup(&attributes, 0);
  pid_t process = -1;
  const int status = ::posix_spawnp(&process, arguments[0], &files, &attributes, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  if (status == ENOENT) refuse("there is no " + words[0] + " on the PATH: run it on a computer of a Slurm cluster.");
  if (status != 0) refuse(words[0] + " cannot be started (" + std::strerror(status) + ").");
  return process;
}

/// Reads both until the program has closed them. False where that takes longer than the limit.
bool read_both(Pipe& output, Pipe& errors, double limit_s, ProgramAnswer& answer) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(limit_s);
  pollfd open[2] = {{output.ends[0], POLLIN, 0}, {errors.ends[0], POLLIN, 0}};
  std::string* texts[2] = {&answer.output, &answer.errors};
  while (open[0].fd >= 0 || open[1].fd >= 0) {
    if (std::chrono::steady_clock::now() > end) return false;
    if (::poll(open, 2, 200) < 0 && errno != EINTR) return false;
    for (int k = 0; k < 2; ++k) {
      if (open[k].fd < 0 || open[k].revents == 0) continue;
      char piece[4096];
      const ssize_t count = ::read(open[k].fd, piece, sizeof piece);
      if (count > 0) texts[k]->append(piece, static_cast<std::size_t>(count));
      else if (count == 0 || errno != EINTR) open[k].fd = -1;
    }
  }
  return true;
}

std::string in_quotes(const ProgramAnswer& answer) {
  const std::string words = last_words(answer.errors + "\n" + answer.output);
  return words.empty() ? "nothing" : "\"" + words + "\"";
}

/// One sentence for an answer that is a refusal.
[[noreturn]] void refuse_submission(const ProgramAnswer& answer) {
  const std::string words = in_quotes(answer);
  if (words.find("nable to contact") != std::string::npos || words.find("configuration file") != std::string::npos)
    refuse("Slurm does not answer (" + words + "): check sinfo, and try again when it lists nodes.");
  refuse("Slurm refuses the job, saying " + words +
         ": correct --slurm-option or the variables SBATCH_*; sinfo lists the partitions.");
}

std::vector<std::string> submission_words(const std::vector<std::string>& own,
                                          const std::vector<std::string>& options) {
  std::vector<std::string> words{"sbatch", "--nodes=1", "--ntasks=1", "--cpus-per-task=1"};
  words.insert(words.end(), own.begin(), own.end());
  words.insert(words.end(), options.begin(), options.end());
  return words;
}

std::vector<std::string> with_cluster(std::vector<std::string> words, const SlurmArray& array) {
  if (!array.cluster.empty()) words.push_back("--clusters=" + array.cluster);
  return words;
}

}  // namespace

ProgramAnswer run_program(const std::vector<std::string>& words, double limit_s) {
  Pipe output, errors;
  const pid_t process = start(words, output, errors);
  output.close_end(1);
  errors.close_end(1);
  ProgramAnswer answer;
  if (!read_both(output, errors, limit_s, answer)) ::kill(-process, SIGKILL);
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {}
  if (WIFEXITED(status)) answer.status = WEXITSTATUS(status);
  return answer;
}

std::optional<SlurmArray> read_submission(const std::string& output, const std::string& name) {
  const std::string line = output.substr(0, output.find('\n'));
  const std::size_t end = std::min(line.find(';'), line.size());
  SlurmArray array{name, line.substr(0, end), end < line.size() ? line.substr(end + 1) : ""};
  if (array.job.empty() || array.job.find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
  return array;
}

std::vector<QueuedTask> read_queue(const std::string& output) {
  std::vector<QueuedTask> tasks;
  std::size_t start = 0;
  while (start < output.size()) {
    const std::size_t end = std::min(output.find('\n', start), output.size());
    const std::string line = output.substr(start, end - start);
    start = end + 1;
    const std::size_t first = line.find('|');
    const std::size_t second = first == std::string::npos ? first : line.find('|', first + 1);
    if (second == std::string::npos || first == 0) continue;
    tasks.push_back({line.substr(0, first), line.substr(first + 1, second - first - 1), line.substr(second + 1)});
  }
  return tasks;
}

std::string last_words(const std::string& output) {
  std::size_t end = output.find_last_not_of(" \r\n");
  if (end == std::string::npos) return {};
  const std::size_t before = output.rfind('\n', end);
  std::string line = output.substr(before == std::string::npos ? 0 : before + 1, end - (before + 1) + 1);
  if (line.starts_with("Try ") && before != std::string::npos) return last_words(output.substr(0, before));
  for (const char* prefix : {"sbatch: ", "slurmstepd: ", "formwright: ", "error: ", "fatal: "})
    if (line.starts_with(prefix)) line.erase(0, std::strlen(prefix));
  constexpr std::size_t longest = 300;
  return line.substr(0, longest);
}

SlurmArray submit_array(const std::string& name, std::size_t tasks, const std::vector<std::string>& options,
                        const std::filesystem::path& folder, const std::vector<std::string>& words) {
  // A percent sign of the folder's name is none of Slurm's own.
  std::string log;
  for (const char c : (folder / "log-").string()) log += c == '%' ? "%%" : std::string(1, c);
  std::vector<std::string> all =
      submission_words({"--parsable", "--job-name=" + name, "--array=0-" + std::to_string(tasks - 1), "--requeue",
                        "--open-mode=append", "--output=" + log + "%a"},
                       options);
  all.insert(all.end(), words.begin(), words.end());
  const ProgramAnswer answer = run_program(all, limit_of_program_s);
  if (answer.status != 0) refuse_submission(answer);
  auto array = read_submission(answer.output, name);
  if (!array) refuse("sbatch printed " + in_quotes(answer) + " and no number of a job.");
  return *array;
}

void check_slurm(const std::vector<std::string>& options, const std::filesystem::path& script) {
  std::vector<std::string> words = submission_words({"--test-only"}, options);
  words.push_back(script.string());
  const ProgramAnswer answer = run_program(words, limit_of_program_s);
  // Nodes that are down or in use now may do later.
  const bool busy = answer.errors.find("Requested node") != std::string::npos;
  if (answer.status != 0 && !busy) refuse_submission(answer);
}

std::optional<std::vector<QueuedTask>> queued_tasks(const SlurmArray& array) {
  const ProgramAnswer answer =
      run_program(with_cluster({"squeue", "--noheader", "--array", "--name=" + array.name, "--format=%T|%N|%r"}, array),
                  limit_of_program_s);
  if (answer.status != 0) return std::nullopt;
  return read_queue(answer.output);
}

void cancel_arrays(const std::vector<SlurmArray>& arrays) {
  if (arrays.empty()) return;
  std::vector<std::string> words = with_cluster({"scancel"}, arrays.front());
  for (const SlurmArray& array : arrays) words.push_back(array.job);
  run_program(words, limit_of_program_s);
}

}  // namespace formwright
