// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Blobs, jobs and results on disk, found again after a restart.
//   DATA/blobs/<sha256>          DATA/jobs/<id>/{job.json, result.json, outputs/<name>}
// A folder under jobs/ is an accepted job once job.json is in it, and none any more once job.json is gone. What is read
// back is checked: blobs by their names, job.json by its own "sha256", result.json by the "result_sha256" in job.json,
// outputs by the "sha256" that the result lists.
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/data/json.h"
#include "system/checked_files.h"
#include "system/durable_files.h"
#include "system/hex_name.h"
#include "jobs/solver_deaths.h"

namespace formwright {

enum class JobState { queued, running, done, failed, cancelled };
const char* to_string(JobState state);

struct StoredJob {
  std::string id;
  JobState state = JobState::queued;
  double submitted_unix_s = 0, finished_unix_s = 0;
  SolverDeaths deaths;
  Json job;       // the message as it came
  Json result;    // {"report", "outputs"} or {"error"}; null until finished
  Json progress;  // last progress, in memory only
  bool finished() const { return state == JobState::done || state == JobState::failed || state == JobState::cancelled; }
};

class JobStore {
 public:
  /// Reads what is there and removes what a crash left half done. Waits for the solver of a worker that was killed to
  /// be gone, too. Throws Error{invalid_input, "--data"} when the folder cannot be used, or another worker uses it.
  explicit JobStore(std::filesystem::path folder);
  JobStore(const JobStore&) = delete;
  JobStore& operator=(const JobStore&) = delete;
  ~JobStore();

  std::filesystem::path blob_path(const std::string& sha256) const { return folder_ / "blobs" / sha256; }
  std::filesystem::path temporary_path();  // for an upload, in the same file system
  std::filesystem::path outputs_folder(const std::string& id) const { return folder_ / "jobs" / id / "outputs"; }

  /// Intermediate results that jobs keep for later runs.
  std::filesystem::path results_folder() const { return folder_ / "results"; }

  /// Open as long as this worker or a solver that inherited it lives.
  int solver_lock() const { return solver_lock_; }

  /// A received file becomes the blob of this name. It is synchronised already (sync_file). Throws StorageError.
  void keep_blob(const std::filesystem::path& received, const std::string& sha256);
  /// Marks a blob as used just now. False where there is none.
  bool touch_blob(const std::string& sha256);
  void remove_blob(const std::string& sha256);

  /// The job is on the disk when this returns. Throws StorageError, and nothing is left of it then.
  StoredJob& add(const Json& message);
  StoredJob* find(const std::string& id);
  std::vector<const StoredJob*> newest_first() const;
  std::vector<std::string> unfinished_oldest_first() const;

  /// An empty folder for the outputs, whatever an earlier attempt left there. Throws StorageError.
  void clear_outputs(const std::string& id);
  void discard_outputs(const std::string& id) { remove_for_good(outputs_folder(id)); }
  /// Writes the job's present state and result. Throws StorageError.
  void save(StoredJob& job);
  /// False when the disk refused: the job may come back with the next start.
  bool remove(const std::string& id);

  /// Removes the oldest finished jobs, and the longest unused blobs and intermediate results, beyond the limits.
  void tidy(std::size_t max_jobs, double max_blob_mb);

  CheckedFiles& checked() { return checked_; }

 private:
  void lock();
  void read_jobs();

  std::filesystem::path folder_;
  int lock_ = -1, solver_lock_ = -1;
  std::map<std::string, StoredJob> jobs_;
  CheckedFiles checked_;
};

}  // namespace formwright
