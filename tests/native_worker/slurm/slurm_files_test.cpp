// SPDX-License-Identifier: GPL-3.0-or-later
// What a job array reads and writes: its list of tasks, who has finished which, and Slurm's own answers.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>
#include <stdlib.h>

#include <fstream>
#include <iterator>

#include "base/error.h"
#include "slurm/finished_tasks.h"
#include "slurm/slurm_commands.h"
#include "slurm/task_list.h"
#include "system/durable_files.h"
#include "system/work_places.h"

namespace formwright {
namespace {

using Catch::Matchers::ContainsSubstring;
namespace fs = std::filesystem;

class SlurmFolder {
 protected:
  SlurmFolder() {
    char name[] = "/tmp/formwright-test-XXXXXX";
    path = ::mkdtemp(name);
  }
  ~SlurmFolder() { fs::remove_all(path); }
  fs::path write(const std::string& text) const {
    std::ofstream(path / "file", std::ios::binary) << text;
    return path / "file";
  }
  std::string text_of(const fs::path& file) const {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  fs::path path;
};

std::vector<ListedTask> tasks(int count) {
  std::vector<ListedTask> list;
  for (int i = 0; i < count; ++i) list.push_back({"key" + std::to_string(i), "{\"recipe\"}", "mould"});
  return list;
}

std::vector<std::size_t> sizes_of(const std::vector<std::vector<ListedTask>>& shares) {
  std::vector<std::size_t> sizes;
  for (const auto& share : shares) sizes.push_back(share.size());
  return sizes;
}

TEST_CASE_METHOD(SlurmFolder, "SlurmFiles.TaskListIsReadBack") {
  write_task_list(path / "tasks", {tasks(2), tasks(1)});
  const auto share = read_share(path / "tasks", 0);
  REQUIRE(share.size() == 2);
  CHECK(share[1].key == "key1");
  CHECK(share[1].recipe == "{\"recipe\"}");
  CHECK(share[1].input_key == "mould");
  CHECK(read_share(path / "tasks", 1).size() == 1);
}

TEST_CASE_METHOD(SlurmFolder, "SlurmFiles.DamagedTaskListIsRefused") {
  write_task_list(path / "tasks", {tasks(2), tasks(1)});
  const std::string whole = text_of(path / "tasks");
  CHECK_THROWS_WITH(read_share(path / "tasks", 2), ContainsSubstring("has 2 shares"));
  CHECK_THROWS_WITH(read_share(path / "none", 0), ContainsSubstring("There is no file"));
  CHECK_THROWS_WITH(read_share(write(whole.substr(0, whole.size() - 1)), 0), ContainsSubstring("cut short"));
  CHECK_THROWS_WITH(read_share(write(""), 0), ContainsSubstring("cut short"));
  const auto checked = [&](const std::string& content) {
    const Bytes bytes = with_checksum(as_bytes(content));
    return write(std::string(as_text(bytes)));
  };
  CHECK_THROWS_WITH(read_share(checked("[]"), 0), ContainsSubstring("another version"));
  CHECK_THROWS_WITH(read_share(checked(R"({"version": 7, "shares": [[]]})"), 0), ContainsSubstring("another version"));
  CHECK_THROWS_WITH(read_share(checked(R"({"version": 1})"), 0), ContainsSubstring("has 0 shares"));
  CHECK_THROWS_WITH(read_share(checked(R"({"version": 1, "shares": [[{"key": 3}]]})"), 0),
                    ContainsSubstring("no list of tasks"));
}

TEST_CASE("SlurmFiles.SharesFollowTheTime") {
  const std::vector<double> alike(6, 1000);
  CHECK(sizes_of(shares_of(tasks(6), alike, 0, 4, 1000)) == std::vector<std::size_t>(6, 1));
  CHECK(sizes_of(shares_of(tasks(6), alike, 0.001, 4, 1000)) == std::vector<std::size_t>{4, 2});
  CHECK(sizes_of(shares_of(tasks(6), alike, 0.01, 4, 1000)) == std::vector<std::size_t>(6, 1));
  CHECK(sizes_of(shares_of(tasks(3), {1000, 4000, 1000}, 0.001, 4, 1000)) == std::vector<std::size_t>{1, 1, 1});
  // Slurm takes no more tasks than this.
  CHECK(sizes_of(shares_of(tasks(6), alike, 0.01, 4, 4)) == std::vector<std::size_t>{2, 2, 2});
  CHECK(shares_of({}, {}, 0, 4, 1000).empty());
}

TEST_CASE_METHOD(SlurmFolder, "SlurmFiles.FinishedTasksOfOtherKindsAreLeftOut") {
  note_finished(path / "file", {"a", "n1", 1.5});
  note_finished(path / "file", {"b", "n2", 0});
  CHECK(read_finished(path / "file").at("a").node == "n1");
  CHECK(read_finished(path / "file").at("a").seconds == 1.5);
  const std::string whole = text_of(path / "file");
  // Killed in the middle of the last line, another version, no numbers, twice the same.
  const auto left = read_finished(write(whole + "2 c 1 n1\n1 d later n1\n1 e -1 n1\n\n1 f\n1 a 2 n2\n1 g 1 n"));
  CHECK(left.size() == 2);
  CHECK(left.at("a").node == "n2");
  CHECK(read_finished(path / "none").empty());
  note_finished(path / "none" / "file", {"a", "n1", 1});
  CHECK_FALSE(fs::exists(path / "none"));
}

TEST_CASE("SlurmAnswers.SubmissionsAndQueues") {
  CHECK(read_submission("12\n", "x")->job == "12");
  CHECK(read_submission("12;big\n", "x")->cluster == "big");
  for (const char* wrong : {"", "\n", "Submitted batch job 12", ";big", "-1"}) {
    CAPTURE(wrong);
    CHECK_FALSE(read_submission(wrong, "x"));
  }
  const auto queue =
      read_queue("CLUSTER: big\nRUNNING|n1|None\nPENDING||Resources\n\nPENDING\n|n1|x\nCOMPLETING|n2|None");
  REQUIRE(queue.size() == 3);
  CHECK(queue[0].node == "n1");
  CHECK(queue[1].reason == "Resources");
  CHECK(queue[2].state == "COMPLETING");
}

TEST_CASE("SlurmAnswers.LastWords") {
  CHECK(last_words("") == "");
  CHECK(last_words("\n \n") == "");
  CHECK(last_words("sbatch: error: Batch job submission failed: Invalid partition\n") ==
        "Batch job submission failed: Invalid partition");
  CHECK(last_words("sbatch: unrecognized option '--x'\nTry \"sbatch --help\" for more information\n") ==
        "unrecognized option '--x'");
  CHECK(last_words("Try again") == "Try again");
}

TEST_CASE("SlurmAnswers.Programs") {
  const ProgramAnswer answer = run_program({"sh", "-c", "echo out; echo err >&2; exit 3"}, 10);
  CHECK(answer.status == 3);
  CHECK(answer.output == "out\n");
  CHECK(answer.errors == "err\n");
  CHECK(run_program({"sleep", "20"}, 0.2).status == -1);
  CHECK_THROWS_WITH(run_program({"formwright-none"}, 1), ContainsSubstring("no formwright-none on the PATH"));
}

TEST_CASE("WorkPlaces.Counts") {
  WorkPlaces places;
  double seconds = -1;
  places.on_made_here = [&](const std::string& key, double s) { seconds = key == "a" ? s : -2; };
  CHECK(places_text(places.now()) == "");
  places.began("a");
  places.began("b");
  places.made("a");
  CHECK(seconds >= 0);
  places.is_made_by("lab", "c");
  places.is_made_by("lab", "d");
  places.found("c");
  CHECK(places_text(places.now()) == "this computer 1 running, 1 done; lab 1 running, 1 done");
  places.gave_up("b");
  places.found("b");
  places.began("d");  // the other run has ended without it
  places.made("d");
  places.set_engine_places({{"n1", 2, 0, 0}, {"n2", 0, 0, 0}, {"Slurm's queue", 0, 0, 7}});
  CHECK(places_text(places.now()) == "this computer 2 done; lab 1 done; n1 2 running; Slurm's queue 7 waiting");
}

TEST_CASE_METHOD(SlurmFolder, "WorkPlaces.SharedFolder") {
  Host host;
  std::vector<WorkPlace> reported;
  host.on_progress = [&](const Progress& progress) { reported = progress.places; };
  share_results(ResultFolder(path), host);
  write("");
  std::ofstream(path / "theirs.claim") << "lab-b 1";
  CHECK(host.claim_result("ours"));
  CHECK_FALSE(
      host.claim_result("ours"));  // for a second prediction that needs the same simulation: no other run is at it
  CHECK_FALSE(host.claim_result("theirs"));
  host.on_progress({});
  REQUIRE(reported.size() == 2);
  CHECK(reported[0].running == 1);
  CHECK(reported[1].name == "lab-b");
  host.keep_result("ours", to_bytes("x"));
  ResultFolder(path).keep("theirs", to_bytes("y"));
  CHECK(host.find_result("theirs"));
  host.on_progress({});
  CHECK(places_text(reported) == "this computer 1 done; lab-b 1 done");
}

}  // namespace
}  // namespace formwright
