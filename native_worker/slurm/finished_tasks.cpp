// SPDX-License-Identifier: GPL-3.0-or-later
#include "slurm/finished_tasks.h"

#include <fcntl.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>

namespace formwright {
namespace {
constexpr const char* line_version = "1";
}  // namespace

void note_finished(const std::filesystem::path& file, const FinishedTask& task) {
  char seconds[32];
  std::snprintf(seconds, sizeof seconds, "%.3f", task.seconds);
  const std::string line = std::string(line_version) + " " + task.key + " " + seconds + " " + task.node + "\n";
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor < 0) return;
  // One call, so that a process that is killed leaves a whole line or a short last one.
  [[maybe_unused]] const auto written = ::write(descriptor, line.data(), line.size());
  ::close(descriptor);
}

std::map<std::string, FinishedTask> read_finished(const std::filesystem::path& file) {
  std::map<std::string, FinishedTask> finished;
  std::ifstream stream(file, std::ios::binary);
  std::string line;
  // A line that ends with the file has no end of its own: it is still being written.
  while (std::getline(stream, line) && !stream.eof()) {
    std::istringstream words(line);
    std::string version;
    FinishedTask task;
    if (words >> version >> task.key >> task.seconds >> task.node && version == line_version &&
        std::isfinite(task.seconds) && task.seconds >= 0)
      finished[task.key] = task;
  }
  return finished;
}

}  // namespace formwright
