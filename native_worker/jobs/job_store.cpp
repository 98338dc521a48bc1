// SPDX-License-Identifier: GPL-3.0-or-later
#include "jobs/job_store.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <set>
#include <thread>

#include "base/error.h"
#include "system/files.h"
#include "system/secret.h"
#include "jobs/stored_job_file.h"

namespace formwright {
namespace {

constexpr double max_results_mb = 1000;
constexpr std::chrono::seconds solver_patience{10};
constexpr std::chrono::minutes making_lasts{10};  // as long as a claim counts (files.h)

struct KeptFile {
  std::filesystem::file_time_type used;
  std::filesystem::path path;
  double mb = 0;
};

/// The longest unused first. Files alone: a folder (lost+found) has no size to speak of, nor has what vanishes
/// meanwhile.
std::vector<KeptFile> files_longest_unused_first(const std::filesystem::path& folder) {
  std::vector<KeptFile> files;
  std::error_code listed, known;
  for (std::filesystem::directory_iterator it(folder, listed), end; !listed && it != end; it.increment(listed)) {
    const std::uintmax_t bytes = it->file_size(known);
    if (known) continue;
    const auto used = it->last_write_time(known);
    if (!known) files.push_back({used, it->path(), 1e-6 * static_cast<double>(bytes)});
  }
  std::sort(files.begin(), files.end(), [](const KeptFile& a, const KeptFile& b) { return a.used < b.used; });
  return files;
}

/// What a process works at (files.h): a claim, or a file under the name it has until it is whole.
bool in_the_making(const KeptFile& file) {
  const std::string name = file.path.filename().string();
  return (name.ends_with(".claim") || name.find(".part-") != std::string::npos) &&
         std::filesystem::file_time_type::clock::now() - file.used < making_lasts;
}

/// Removes the longest unused files of `folder` that are not `needed`, until the rest is no larger than `max_mb`.
void remove_oldest(const std::filesystem::path& folder, double max_mb, const std::set<std::string>& needed) {
  const auto files = files_longest_unused_first(folder);
  double total_mb = 0;
  for (const KeptFile& file : files) total_mb += file.mb;
  for (const KeptFile& file : files) {
    if (total_mb <= max_mb) break;
    if (needed.contains(file.path.filename().string()) || in_the_making(file)) continue;
    std::error_code status;
    std::filesystem::remove(file.path, status);
    total_mb -= file.mb;  // also where it cannot go: no others do in its stead
  }
}

double unix_seconds() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

/// Opened for a lock that the system drops with the last process that has it, however that ends.
int lock_file(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (descriptor < 0)
    throw Error(ErrorCode::invalid_input, "--data",
                "The folder " + path.parent_path().string() + " cannot be written to (" + std::strerror(errno) +
                    "): choose another with --data.");
  return descriptor;
}

bool locked_within(int descriptor, std::chrono::milliseconds patience) {
  const auto end = std::chrono::steady_clock::now() + patience;
  while (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK || std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

}  // namespace

const char* to_string(JobState state) {
  switch (state) {
    case JobState::queued: return "queued";
    case JobState::running: return "running";
    case JobState::done: return "done";
    case JobState::failed: return "failed";
    case JobState::cancelled: return "cancelled";
  }
  return "failed";
}

JobStore::JobStore(std::filesystem::path folder) : folder_(std::move(folder)) {
  std::error_code status;
  const bool made_here = !std::filesystem::exists(folder_, status);
  try {
    for (const char* part : {"blobs", "jobs", "uploads"}) make_folder(folder_ / part);
  } catch (const StorageError& error) {
    throw Error(ErrorCode::invalid_input, "--data",
                "The folder " + folder_.string() + " cannot be used: " + error.what());
  }
  if (made_here) std::filesystem::permissions(folder_, std::filesystem::perms::owner_all, status);
  lock();
  read_jobs();
}

void JobStore::lock() {
  // Two workers would run each other's jobs.
  lock_ = lock_file(folder_ / "lock");
  if (!locked_within(lock_, std::chrono::milliseconds(0))) {
    ::close(lock_);
    throw Error(
        ErrorCode::invalid_input, "--data",
        "Another worker keeps its jobs in " + folder_.string() + ": use that one, or name another folder with --data.");
  }
  // A solver whose worker was killed ends with it, but a moment later: until then it writes.
  try {
    solver_lock_ = lock_file(folder_ / "solver_lock");
  } catch (...) {
    ::close(lock_);
    throw;
  }
  if (!locked_within(solver_lock_, solver_patience)) {
    ::close(solver_lock_);
    ::close(lock_);
    throw Error(ErrorCode::invalid_input, "--data",
                "The solver of a worker that has ended still writes to " + folder_.string() +
                    ": end that process (formwright run-jobs) and try again.");
  }
}

void JobStore::read_jobs() {
  std::error_code status;
  const auto paths_in = [&](const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> paths;
    for (std::filesystem::directory_iterator it(folder, status), end; !status && it != end; it.increment(status))
      paths.push_back(it->path());
    return paths;
  };
  for (const auto& left_over : paths_in(folder_ / "uploads")) std::filesystem::remove(left_over, status);
  for (const auto& path : paths_in(folder_))
    if (path.filename().string().starts_with("slicing-")) std::filesystem::remove_all(path, status);
  remove_abandoned_files(folder_);
  remove_abandoned_files(folder_ / "blobs");
  ResultFolder(results_folder()).remove_abandoned();
  for (const auto& path : paths_in(folder_ / "jobs")) {
    const std::string id = path.filename().string();
    if (!is_hex_name(id, 32)) continue;
    if (!holds_job(path)) {  // never accepted, or being removed
      remove_for_good(path);
      continue;
    }
    remove_abandoned_files(path);
    StoredJob job = read_job(path);
    if (job.state == JobState::done) remove_abandoned_files(outputs_folder(id));
    else if (std::filesystem::exists(outputs_folder(id), status)) discard_outputs(id);
    if (!job.finished()) std::filesystem::remove(path / "result.json", status);
    jobs_.emplace(id, std::move(job));
  }
}

JobStore::~JobStore() {
  ::close(solver_lock_);
  ::close(lock_);
}

std::filesystem::path JobStore::temporary_path() { return folder_ / "uploads" / random_hex(16); }

void JobStore::keep_blob(const std::filesystem::path& received, const std::string& sha256) {
  move_file(received, blob_path(sha256));
  if (const auto stamp = stamp_of(blob_path(sha256))) checked_.note(blob_path(sha256), sha256, *stamp);
}

bool JobStore::touch_blob(const std::string& sha256) {
  const auto path = blob_path(sha256);
  const bool known = checked_.known(path, sha256);
  std::error_code missing;
  std::filesystem::last_write_time(path, std::filesystem::file_time_type::clock::now(), missing);
  if (missing) return false;
  if (const auto stamp = stamp_of(path); stamp && known) checked_.note(path, sha256, *stamp);
  return true;
}

void JobStore::remove_blob(const std::string& sha256) {
  std::error_code status;
  std::filesystem::remove(blob_path(sha256), status);
}

StoredJob& JobStore::add(const Json& message) {
  StoredJob job;
  job.id = random_hex(16);
  job.submitted_unix_s = unix_seconds();
  job.job = message;
  const auto folder = folder_ / "jobs" / job.id;
  try {
    make_folder(folder);
    write_job(folder, job);
  } catch (const StorageError&) {
    remove_job(folder);
    throw;
  }
  return jobs_.emplace(job.id, std::move(job)).first->second;
}

StoredJob* JobStore::find(const std::string& id) {
  const auto it = jobs_.find(id);
  return it == jobs_.end() ? nullptr : &it->second;
}

std::vector<const StoredJob*> JobStore::newest_first() const {
  std::vector<const StoredJob*> list;
  for (const auto& [id, job] : jobs_) list.push_back(&job);
  std::sort(list.begin(), list.end(),
            [](const StoredJob* a, const StoredJob* b) { return a->submitted_unix_s > b->submitted_unix_s; });
  return list;
}

std::vector<std::string> JobStore::unfinished_oldest_first() const {
  std::vector<std::string> ids;
  const auto list = newest_first();
  for (auto it = list.rbegin(); it != list.rend(); ++it)
    if (!(*it)->finished()) ids.push_back((*it)->id);
  return ids;
}

void JobStore::clear_outputs(const std::string& id) {
  discard_outputs(id);
  make_folder(outputs_folder(id));
}

void JobStore::save(StoredJob& job) {
  if (job.finished() && job.finished_unix_s == 0) job.finished_unix_s = unix_seconds();
  write_job(folder_ / "jobs" / job.id, job);
}

bool JobStore::remove(const std::string& id) {
  if (!remove_job(folder_ / "jobs" / id)) return false;
  jobs_.erase(id);
  return true;
}

void JobStore::tidy(std::size_t max_jobs, double max_blob_mb) {
  const auto list = newest_first();
  for (std::size_t i = list.size(); i-- > max_jobs;)
    if (list[i]->finished()) remove(std::string(list[i]->id));

  std::set<std::string> needed;
  for (const auto& [id, job] : jobs_)
    if (!job.finished())
      if (const auto inputs = job.job.find("inputs"); inputs != job.job.end())
        for (const auto& [name, input] : inputs->items()) needed.insert(input.value("sha256", ""));
  remove_oldest(folder_ / "blobs", max_blob_mb, needed);
  remove_oldest(results_folder(), max_results_mb, {});
}

}  // namespace formwright
