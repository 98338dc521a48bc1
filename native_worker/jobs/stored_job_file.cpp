// SPDX-License-Identifier: GPL-3.0-or-later
#include "jobs/stored_job_file.h"

#include "base/error.h"
#include "base/sha256.h"
#include "system/files.h"

namespace formwright {
namespace {

std::optional<JobState> state_of(const std::string& name) {
  for (const JobState state :
       {JobState::queued, JobState::running, JobState::done, JobState::failed, JobState::cancelled})
    if (name == to_string(state)) return state;
  return std::nullopt;
}

/// Releases up to 0.1.0 wrote no checksums; they counted "attempts", which nobody does since.
bool without_checksum(const Json& text) { return !text.contains("sha256") && text.contains("attempts"); }

bool intact(Json text) {
  if (without_checksum(text)) return true;
  const std::string hash = text.at("sha256").get<std::string>();
  text.erase("sha256");
  return sha256_hex(as_bytes(text.dump())) == hash;
}

/// Null when it is not the one that was written.
Json read_result(const std::filesystem::path& path, const Json& job_text) {
  try {
    const auto bytes = read_file(path, "data");
    if (!without_checksum(job_text) && sha256_hex(*bytes) != job_text.at("result_sha256").get<std::string>())
      return nullptr;
    return Json::parse(as_text(*bytes));
  } catch (const std::exception&) {
    return nullptr;
  }
}

StoredJob altered_job(const std::filesystem::path& folder) {
  StoredJob job;
  job.id = folder.filename().string();
  job.state = JobState::failed;
  if (const auto stamp = stamp_of(folder / "job.json"))
    job.submitted_unix_s = job.finished_unix_s = 1e-9 * static_cast<double>(stamp->modified_ns);
  job.job = Json::object();
  job.result = {{"error",
                 {{"code", to_string(ErrorCode::internal)},
                  {"where", ""},
                  {"message", "The stored job was altered on the disk or cannot be read: send it again."}}}};
  return job;
}

}  // namespace

void write_job(const std::filesystem::path& folder, const StoredJob& job) {
  Json text = {{"state", to_string(job.state)},
               {"submitted_unix_s", job.submitted_unix_s},
               {"finished_unix_s", job.finished_unix_s},
               {"solver_deaths", job.deaths.json()},
               {"job", job.job}};
  if (job.finished()) {
    const std::string result = job.result.dump();
    text["result_sha256"] = sha256_hex(as_bytes(result));
    write_file(folder / "result.json", as_bytes(result));
  }
  text["sha256"] = sha256_hex(as_bytes(text.dump()));
  write_file(folder / "job.json", as_bytes(text.dump()));
}

StoredJob read_job(const std::filesystem::path& folder) {
  try {
    const Json text = Json::parse(as_text(*read_file(folder / "job.json", "data")));
    const auto state = state_of(text.at("state").get<std::string>());
    if (!state || !intact(text)) return altered_job(folder);
    StoredJob job;
    job.id = folder.filename().string();
    job.state = *state;
    job.submitted_unix_s = text.at("submitted_unix_s").get<double>();
    job.finished_unix_s = text.at("finished_unix_s").get<double>();
    if (text.contains("solver_deaths")) job.deaths = SolverDeaths::from_json(text["solver_deaths"]);
    job.job = text.at("job");
    if (job.finished()) job.result = read_result(folder / "result.json", text);
    if (!job.result.is_object()) job.state = JobState::queued, job.finished_unix_s = 0;
    return job;
  } catch (const std::exception&) {
    return altered_job(folder);
  }
}

bool holds_job(const std::filesystem::path& folder) {
  std::error_code status;
  // An error of the disk is no proof that nothing is there.
  return std::filesystem::exists(folder / "job.json", status) || status;
}

bool remove_job(const std::filesystem::path& folder) {
  return remove_for_good(folder / "job.json") && remove_for_good(folder);
}

}  // namespace formwright
