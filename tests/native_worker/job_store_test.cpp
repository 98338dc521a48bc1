// SPDX-License-Identifier: GPL-3.0-or-later
#include "jobs/job_store.h"

#include <catch2/catch_test_macros.hpp>
#include <stdlib.h>

#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <iterator>

#include "base/sha256.h"
#include "system/files.h"

namespace formwright {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

class JobStoreFolder {
 protected:
  JobStoreFolder() {
    char name[] = "/tmp/formwright-test-XXXXXX";
    path = ::mkdtemp(name);
    fs::create_directories(path / "results");
  }
  ~JobStoreFolder() { fs::remove_all(path); }

  /// Its blocks are never written: a file of a gigabyte costs nothing here.
  void put(const fs::path& file, double mb, std::chrono::minutes unused) const {
    std::ofstream(path / file).close();
    fs::resize_file(path / file, static_cast<std::uintmax_t>(mb * 1e6));
    fs::last_write_time(path / file, fs::file_time_type::clock::now() - unused);
  }
  bool there(const fs::path& file) const { return fs::exists(path / file); }
  void tidy(double max_blob_mb) const { JobStore(path).tidy(10, max_blob_mb); }

  void write(const fs::path& file, const std::string& text) const { std::ofstream(path / file) << text; }
  std::string read(const fs::path& file) const {
    std::ifstream stream(path / file);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  void alter(const fs::path& file) const {
    std::string text = read(file);
    text[text.size() / 2] = static_cast<char>(text[text.size() / 2] ^ 1);
    write(file, text);
  }
  std::string finished_job(JobStore& store) const {
    StoredJob& job = store.add({{"operation", "import"}});
    store.clear_outputs(job.id);
    job.state = JobState::done;
    job.result = result;
    store.save(job);
    return job.id;
  }

  fs::path path;
  const Json result = {{"report", {{"faces", 4}}}, {"outputs", Json::object()}};
};

TEST_CASE_METHOD(JobStoreFolder, "JobStoreFolder.the_longest_unused_goes_until_the_rest_fits") {
  fs::create_directories(path / "blobs");
  put("blobs/new", 4, 1min);
  put("blobs/oldest", 4, 60min);
  put("blobs/old", 4, 30min);
  put("results/new", 400, 1min);
  put("results/oldest", 400, 60min);
  put("results/old", 400, 30min);
  tidy(13);
  CHECK(there("blobs/oldest"));
  CHECK_FALSE(there("results/oldest"));  // 1000 MB of these are kept
  tidy(9);
  CHECK_FALSE(there("blobs/oldest"));
  for (const char* kept : {"blobs/old", "blobs/new", "results/old", "results/new"}) {
    INFO(kept);
    CHECK(there(kept));
  }
}

TEST_CASE_METHOD(JobStoreFolder, "JobStoreFolder.a_folder_among_the_files_costs_none_of_them") {
  fs::create_directories(path / "blobs");
  put("blobs/one", 4, 60min);
  put("results/one", 4, 60min);
  // Its own time is now: whatever it was taken to weigh, all that is older went before it did.
  fs::create_directories(path / "blobs/lost+found");
  fs::create_directories(path / "results/lost+found");
  fs::create_symlink("nowhere", path / "results/link");  // whose file is gone
  tidy(12);
  for (const char* kept : {"blobs/one", "results/one", "blobs/lost+found", "results/lost+found"}) {
    INFO(kept);
    CHECK(there(kept));
  }
}

TEST_CASE_METHOD(JobStoreFolder, "JobStoreFolder.what_is_being_made_stays_and_what_was_left_over_goes") {
  JobStore store(path);
  put("blobs/sliced.part-7", 4, 1min);
  put("blobs/crashed.part-8", 4, 60min);
  put("blobs/other", 4, 0min);
  put("results/key.claim", 2000, 1min);  // no claim weighs that much; here it must not
  put("results/other.claim", 2000, 60min);
  store.tidy(10, 1);
  CHECK(there("blobs/sliced.part-7"));
  CHECK_FALSE(there("blobs/crashed.part-8"));
  CHECK_FALSE(there("blobs/other"));
  CHECK(there("results/key.claim"));
  CHECK_FALSE(there("results/other.claim"));
}

// Above every number that Linux gives (pid_max is at most 2^22).
const std::string ended = ".part-99999999-1";

TEST_CASE_METHOD(JobStoreFolder, "JobStoreFolder.a_start_removes_what_ended_processes_left_half_done") {
  const std::string id(32, 'c');
  fs::create_directories(path / "jobs" / id / "outputs");
  fs::create_directories(path / "slicing-0123456789abcdef/home");
  for (const char* folder : {"blobs", "uploads"}) fs::create_directories(path / folder);
  for (const std::string& file : {"blobs/b" + ended, "results/r" + ended, "machines.json" + ended,
                                  "jobs/" + id + "/outputs/x", std::string("uploads/u")})
    write(file, "half");
  char machine[256] = "";
  ::gethostname(machine, sizeof machine - 1);
  write("results/key.claim", std::string(machine) + " 99999999");
  write("results/other.claim", "elsewhere 99999999");
  JobStore store(path);
  CHECK(store.find(id) == nullptr);  // no job.json: it was never accepted
  for (const std::string& gone :
       {"blobs/b" + ended, "results/r" + ended, "machines.json" + ended, "jobs/" + id, std::string("uploads/u"),
        std::string("slicing-0123456789abcdef"), std::string("results/key.claim")}) {
    INFO(gone);
    CHECK_FALSE(there(gone));
  }
  CHECK(there("results/other.claim"));  // whether its owner runs only that machine knows
}

TEST_CASE_METHOD(JobStoreFolder, "JobStoreFolder.jobs_come_back_as_they_were") {
  std::string queued, done;
  {
    JobStore store(path);
    StoredJob& first = store.add({{"operation", "import"}});
    first.deaths.crashed = 1;
    store.save(first);
    queued = first.id;
    done = finished_job(store);
  }
  JobStore store(path);
  REQUIRE(store.find(queued) != nullptr);
  CHECK(store.find(queued)->state == JobState::queued);
  CHECK(store.find(queued)->deaths.crashed == 1);
  REQUIRE(store.find(done) != nullptr);
  CHECK(store.find(done)->state == JobState::done);
  CHECK(store.find(done)->result == result);
  CHECK(store.remove(done));
  CHECK_FALSE(there("jobs/" + done));
  CHECK(store.unfinished_oldest_first() == std::vector<std::string>{queued});
}

TEST_CASE_METHOD(JobStoreFolder, "JobStoreFolder.an_altered_result_makes_the_job_run_again") {
  std::string altered, gone;
  {
    JobStore store(path);
    altered = finished_job(store), gone = finished_job(store);
  }
  alter("jobs/" + altered + "/result.json");
  fs::remove(path / "jobs" / gone / "result.json");
  JobStore store(path);
  for (const std::string& id : {altered, gone}) {
    REQUIRE(store.find(id) != nullptr);
    CHECK(store.find(id)->state == JobState::queued);
    CHECK_FALSE(there("jobs/" + id + "/result.json"));
  }
}

TEST_CASE_METHOD(JobStoreFolder, "JobStoreFolder.every_altered_byte_of_a_job_is_noticed") {
  std::string id;
  {
    JobStore store(path);
    id = store.add({{"operation", "import"}, {"parameters", {{"size_mm", 80}}}}).id;
  }
  const fs::path file = fs::path("jobs") / id / "job.json";
  const std::string whole = read(file);
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string altered = whole;
    altered[at] = static_cast<char>(altered[at] ^ 4);
    write(file, altered);
    JobStore store(path);
    REQUIRE(store.find(id) != nullptr);
    {
      INFO(altered);
      CHECK(store.find(id)->state == JobState::failed);
    }
    CHECK(store.find(id)->result.contains("error"));
  }
}

TEST_CASE_METHOD(JobStoreFolder, "JobStoreFolder.jobs_of_releases_without_checksums_are_read") {
  const std::string done(32, 'd'), running(32, 'e');
  const Json head = {
      {"submitted_unix_s", 5.5}, {"finished_unix_s", 6.5}, {"attempts", 2}, {"job", {{"operation", "import"}}}};
  for (const auto& [id, state] : {std::pair{done, "done"}, std::pair{running, "running"}}) {
    fs::create_directories(path / "jobs" / id / "outputs");
    Json text = head;
    text["state"] = state;
    write(fs::path("jobs") / id / "job.json", text.dump());
  }
  write(fs::path("jobs") / done / "result.json", result.dump());
  JobStore store(path);
  REQUIRE(store.find(done) != nullptr);
  CHECK(store.find(done)->state == JobState::done);
  CHECK(store.find(done)->result == result);
  REQUIRE(store.find(running) != nullptr);
  CHECK(store.find(running)->state == JobState::queued);
  CHECK_FALSE(store.find(running)->deaths.verdict());  // deaths of the worker were counted as attempts
}

TEST_CASE_METHOD(JobStoreFolder, "JobStoreFolder.a_job_that_finds_no_place_leaves_nothing") {
  JobStore store(path);
  fs::remove_all(path / "jobs");
  write("jobs", "a file where the folder was");
  CHECK_THROWS_AS(store.add({{"operation", "import"}}), StorageError);
  CHECK(store.newest_first().empty());
}

TEST_CASE_METHOD(JobStoreFolder, "JobStoreFolder.a_blob_that_is_touched_stays_known_and_one_that_is_altered_does_not") {
  JobStore store(path);
  const std::string content = "mesh", hash = sha256_hex(as_bytes(content));
  write("uploads/received", content);
  store.keep_blob(path / "uploads/received", hash);
  CHECK(store.checked().known(store.blob_path(hash), hash));
  CHECK(store.touch_blob(hash));
  CHECK(store.checked().known(store.blob_path(hash), hash));
  CHECK(has_sha256(store.blob_path(hash), hash));
  alter("blobs/" + hash);
  CHECK_FALSE(store.checked().known(store.blob_path(hash), hash));
  CHECK_FALSE(has_sha256(store.blob_path(hash), hash));
  CHECK_THROWS_AS(read_checked_file(store.blob_path(hash), hash, "mesh"), Error);
  store.remove_blob(hash);
  CHECK_FALSE(store.touch_blob(hash));
}

TEST_CASE_METHOD(JobStoreFolder, "JobStoreFolder.a_kept_simulation_that_was_altered_is_none") {
  const ResultFolder results(path / "results");
  const Bytes bytes = to_bytes("a formed sheet");
  REQUIRE(results.claim("key"));
  CHECK_FALSE(ResultFolder(path / "results").claim("key"));
  results.keep("key", bytes);
  CHECK(results.find("key") == bytes);
  CHECK(results.claim("key"));
  results.release("key");
  const std::string whole = read("results/key");
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string altered = whole;
    altered[at] = static_cast<char>(altered[at] ^ 1);
    write("results/key", altered);
    INFO(at);
    CHECK(results.find("key") == std::nullopt);
  }
  results.keep("key", bytes);
  CHECK(results.find("key") == bytes);
  CHECK(std::distance(fs::directory_iterator(path / "results"), fs::directory_iterator()) == 1);
}

TEST_CASE("SolverDeaths.kills_are_forgiven_and_crashes_are_not") {
  CHECK(death_of(SIGKILL, false) == SolverDeath::killed);
  CHECK(death_of(SIGKILL, true) == SolverDeath::out_of_memory);
  CHECK(death_of(SIGTERM, false) == SolverDeath::ended);
  CHECK(death_of(SIGSEGV, true) == SolverDeath::crashed);
  CHECK(death_of(1 << 8, false) == SolverDeath::crashed);  // exit(1)
  const auto deaths_until_verdict = [](SolverDeath death, bool restarts) {
    SolverDeaths deaths;
    int count = 0;
    while (!deaths.verdict() && count < 1000) {
      deaths.count(death);
      CHECK(deaths.pause() <= 10s);
      if (restarts) deaths = SolverDeaths::from_json(deaths.json());
      ++count;
    }
    return count;
  };
  for (const bool restarts : {false, true}) {  // of the worker between two deaths
    CHECK(deaths_until_verdict(SolverDeath::crashed, restarts) == 2);
    CHECK(deaths_until_verdict(SolverDeath::out_of_memory, restarts) == 2);
    CHECK(deaths_until_verdict(SolverDeath::killed, restarts) == (restarts ? 1000 : 20));
    CHECK(deaths_until_verdict(SolverDeath::ended, restarts) == 1000);
  }
}

}  // namespace
}  // namespace formwright
