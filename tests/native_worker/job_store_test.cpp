// SPDX-License-Identifier: GPL-3.0-or-later
#include "job_store.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <chrono>
#include <fstream>

namespace formwright {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

class JobStoreFolder : public testing::Test {
 protected:
  JobStoreFolder() {
    char name[] = "/tmp/formwright-test-XXXXXX";
    path = ::mkdtemp(name);
    fs::create_directories(path / "results");
  }
  ~JobStoreFolder() override { fs::remove_all(path); }

  /// Its blocks are never written: a file of a gigabyte costs nothing here.
  void put(const fs::path& file, double mb, std::chrono::minutes unused) const {
    std::ofstream(path / file).close();
    fs::resize_file(path / file, static_cast<std::uintmax_t>(mb * 1e6));
    fs::last_write_time(path / file, fs::file_time_type::clock::now() - unused);
  }
  bool there(const fs::path& file) const { return fs::exists(path / file); }
  void tidy(double most_blob_mb) const { JobStore(path).tidy(10, most_blob_mb); }

  fs::path path;
};

TEST_F(JobStoreFolder, the_longest_unused_goes_until_the_rest_fits) {
  fs::create_directories(path / "blobs");
  put("blobs/new", 4, 1min);
  put("blobs/oldest", 4, 60min);
  put("blobs/old", 4, 30min);
  put("results/new", 400, 1min);
  put("results/oldest", 400, 60min);
  put("results/old", 400, 30min);
  tidy(13);
  EXPECT_TRUE(there("blobs/oldest"));
  EXPECT_FALSE(there("results/oldest"));  // 1000 MB of these are kept
  tidy(9);
  EXPECT_FALSE(there("blobs/oldest"));
  for (const char* kept : {"blobs/old", "blobs/new", "results/old", "results/new"}) EXPECT_TRUE(there(kept)) << kept;
}

TEST_F(JobStoreFolder, a_folder_among_the_files_costs_none_of_them) {
  fs::create_directories(path / "blobs");
  put("blobs/one", 4, 60min);
  put("results/one", 4, 60min);
  // Its own time is now: whatever it was taken to weigh, all that is older went before it did.
  fs::create_directories(path / "blobs/lost+found");
  fs::create_directories(path / "results/lost+found");
  fs::create_symlink("nowhere", path / "results/link");  // whose file is gone
  tidy(12);
  for (const char* kept : {"blobs/one", "results/one", "blobs/lost+found", "results/lost+found"})
    EXPECT_TRUE(there(kept)) << kept;
}

TEST_F(JobStoreFolder, what_is_being_made_stays_and_what_was_left_over_goes) {
  fs::create_directories(path / "blobs");
  put("blobs/sliced.part-7", 4, 1min);
  put("blobs/crashed.part-8", 4, 60min);
  put("blobs/other", 4, 0min);
  put("results/key.claim", 2000, 1min);  // no claim weighs that much; here it must not
  put("results/other.claim", 2000, 60min);
  tidy(1);
  EXPECT_TRUE(there("blobs/sliced.part-7"));
  EXPECT_FALSE(there("blobs/crashed.part-8"));
  EXPECT_FALSE(there("blobs/other"));
  EXPECT_TRUE(there("results/key.claim"));
  EXPECT_FALSE(there("results/other.claim"));
}

}  // namespace
}  // namespace formwright
