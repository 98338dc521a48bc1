// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Blobs, jobs and results on disk, found again after a restart.
//   DATA/blobs/<sha256>          DATA/jobs/<id>/{job.json, result.json, outputs/<name>}
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/json.h"
#include "hex_name.h"

namespace formwright {

enum class JobState { queued, running, done, failed, cancelled };
const char* to_string(JobState state);

struct StoredJob {
  std::string id;
  JobState state = JobState::queued;
  double submitted_unix_s = 0, finished_unix_s = 0;
  int attempts = 0;  // how often it was started; a job that took the process down twice is not tried again
  Json job;          // the message as it came
  Json result;       // {"report", "outputs"} or {"error"}; null until finished
  Json progress;     // last progress, in memory only
  bool finished() const { return state == JobState::done || state == JobState::failed || state == JobState::cancelled; }
};

class JobStore {
 public:
  /// Reads what is there. Throws Error{invalid_input, "--data"} when the folder cannot be used, or another worker uses
  /// it.
  explicit JobStore(std::filesystem::path folder);
  JobStore(const JobStore&) = delete;
  JobStore& operator=(const JobStore&) = delete;
  ~JobStore();

  std::filesystem::path blob_path(const std::string& sha256) const { return folder_ / "blobs" / sha256; }
  std::filesystem::path temporary_path();  // for an upload, in the same file system
  std::filesystem::path outputs_folder(const std::string& id) const { return folder_ / "jobs" / id / "outputs"; }

  /// Intermediate results that jobs keep for later runs.
  std::filesystem::path results_folder() const { return folder_ / "results"; }

  StoredJob& add(const Json& message);
  StoredJob* find(const std::string& id);
  std::vector<const StoredJob*> newest_first() const;
  std::vector<std::string> unfinished_oldest_first() const;

  /// Writes the job's present state; an error of the disk becomes the job's error, never an exception.
  void save(StoredJob& job);
  void remove(const std::string& id);

  /// Removes the oldest finished jobs, and the longest unused blobs and intermediate results, beyond the limits.
  void tidy(std::size_t most_jobs, double most_blob_mb);

 private:
  std::filesystem::path folder_;
  int lock_ = -1;
  std::map<std::string, StoredJob> jobs_;
};

}  // namespace formwright
