// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Which node has made which simulation, and in what time: a line each, added by the tasks of a job array to files of
// their own. They count only for what is shown and for how large the next shares are; results are known by their keys.
#include <filesystem>
#include <map>
#include <string>

namespace formwright {

struct FinishedTask {
  std::string key, node;
  double seconds = 0;
};

/// Adds a line at once; nothing where the file cannot be written.
void note_finished(const std::filesystem::path& file, const FinishedTask& task);

/// Lines of a file by key. Left out: a last line that is not whole, lines of another version, and what is no such line.
std::map<std::string, FinishedTask> read_finished(const std::filesystem::path& file);

}  // namespace formwright
