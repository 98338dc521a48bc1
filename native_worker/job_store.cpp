// SPDX-License-Identifier: GPL-3.0-or-later
#include "job_store.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <set>

#include "base/error.h"
#include "files.h"
#include "secret.h"

namespace formwright {
namespace {

constexpr double most_results_mb = 1000;
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

/// Removes the longest unused files of `folder` that are not `needed`, until the rest is no larger than `most_mb`.
void remove_oldest(const std::filesystem::path& folder, double most_mb, const std::set<std::string>& needed) {
  const auto files = files_longest_unused_first(folder);
  double total_mb = 0;
  for (const KeptFile& file : files) total_mb += file.mb;
  for (const KeptFile& file : files) {
    if (total_mb <= most_mb) break;
    if (needed.contains(file.path.filename().string()) || in_the_making(file)) continue;
    std::error_code status;
    std::filesystem::remove(file.path, status);
    total_mb -= file.mb;  // also where it cannot go: no others do in its stead
  }
}

double unix_seconds() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

std::optional<JobState> state_of(const std::string& name) {
  for (const JobState state :
       {JobState::queued, JobState::running, JobState::done, JobState::failed, JobState::cancelled})
    if (name == to_string(state)) return state;
  return std::nullopt;
}

std::optional<StoredJob> read_job(const std::filesystem::path& folder) {
  try {
    const Json text = Json::parse(as_text(*read_file(folder / "job.json", "data")));
    StoredJob job;
    job.id = folder.filename().string();
    const auto state = state_of(text.at("state").get<std::string>());
    if (!state) return std::nullopt;
    job.state = *state;
    job.submitted_unix_s = text.at("submitted_unix_s").get<double>();
    job.finished_unix_s = text.at("finished_unix_s").get<double>();
    job.attempts = text.at("attempts").get<int>();
    job.job = text.at("job");
    if (job.finished()) job.result = Json::parse(as_text(*read_file(folder / "result.json", "data")));
    else job.state = JobState::queued;
    return job;
  } catch (const std::exception&) {
    return std::nullopt;  // half a folder from a crash: it is not a job
  }
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
  for (const char* part : {"blobs", "jobs", "uploads"}) {
    std::filesystem::create_directories(folder_ / part, status);
    if (!std::filesystem::is_directory(folder_ / part))
      throw Error(
          ErrorCode::invalid_input, "--data",
          "The folder " + folder_.string() + " cannot be used (" + status.message() + "): choose another with --data.");
  }
  if (made_here) std::filesystem::permissions(folder_, std::filesystem::perms::owner_all, status);
  // Two workers would run each other's jobs. The system drops the lock with the process, however it ends.
  lock_ = ::open((folder_ / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (lock_ < 0 || ::flock(lock_, LOCK_EX | LOCK_NB) != 0) {
    const bool taken = lock_ >= 0 && errno == EWOULDBLOCK;
    if (lock_ >= 0) ::close(lock_);
    if (taken)
      throw Error(ErrorCode::invalid_input, "--data",
                  "Another worker keeps its jobs in " + folder_.string() +
                      ": use that one, or name another folder with --data.");
    throw Error(ErrorCode::invalid_input, "--data",
                "The folder " + folder_.string() + " cannot be written to: choose another with --data.");
  }
  for (const auto& left_over : std::filesystem::directory_iterator(folder_ / "uploads", status))
    std::filesystem::remove(left_over.path(), status);
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "jobs", status)) {
    if (!is_hex_name(entry.path().filename().string(), 32)) continue;
    if (auto job = read_job(entry.path())) jobs_.emplace(job->id, std::move(*job));
  }
}

JobStore::~JobStore() { ::close(lock_); }

std::filesystem::path JobStore::temporary_path() { return folder_ / "uploads" / random_hex(16); }

StoredJob& JobStore::add(const Json& message) {
  StoredJob job;
  job.id = random_hex(16);
  job.submitted_unix_s = unix_seconds();
  job.job = message;
  StoredJob& kept = jobs_.emplace(job.id, std::move(job)).first->second;
  std::error_code status;
  std::filesystem::create_directories(outputs_folder(kept.id), status);
  save(kept);
  return kept;
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

void JobStore::save(StoredJob& job) {
  if (job.finished() && job.finished_unix_s == 0) job.finished_unix_s = unix_seconds();
  const Json text = {{"state", to_string(job.state)},
                     {"submitted_unix_s", job.submitted_unix_s},
                     {"finished_unix_s", job.finished_unix_s},
                     {"attempts", job.attempts},
                     {"job", job.job}};
  const std::filesystem::path folder = folder_ / "jobs" / job.id;
  try {
    if (job.finished()) write_file(folder / "result.json", as_bytes(job.result.dump()));
    write_file(folder / "job.json", as_bytes(text.dump()));
  } catch (const Error& error) {
    job.state = JobState::failed;
    job.finished_unix_s = unix_seconds();
    job.result = {{"error", {{"code", to_string(ErrorCode::internal)}, {"where", ""}, {"message", error.what()}}}};
  }
}

void JobStore::remove(const std::string& id) {
  jobs_.erase(id);
  std::error_code status;
  std::filesystem::remove_all(folder_ / "jobs" / id, status);
}

void JobStore::tidy(std::size_t most_jobs, double most_blob_mb) {
  const auto list = newest_first();
  for (std::size_t i = list.size(); i-- > most_jobs;)
    if (list[i]->finished()) remove(std::string(list[i]->id));

  std::set<std::string> needed;
  for (const auto& [id, job] : jobs_)
    if (!job.finished())
      if (const auto inputs = job.job.find("inputs"); inputs != job.job.end())
        for (const auto& [name, input] : inputs->items()) needed.insert(input.value("sha256", ""));
  remove_oldest(folder_ / "blobs", most_blob_mb, needed);
  remove_oldest(results_folder(), most_results_mb, {});
}

}  // namespace formwright
