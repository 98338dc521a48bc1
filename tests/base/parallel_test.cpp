// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.h"

#include <catch2/catch_test_macros.hpp>

#ifdef __linux__
#include <sched.h>
#endif

#include <atomic>
#include <chrono>
#include <mutex>
#include <numeric>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

namespace formwright {
namespace {

TEST_CASE("ParallelFor.VisitsEveryIndexOnce") {
  for (const std::size_t count : {0u, 1u, 7u, 1000u, 4097u})
    for (const std::size_t grain : {0u, 1u, 64u, 5000u}) {
      std::vector<std::atomic<int>> visits(count);
      parallel_for(count, grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) ++visits[i];
      });
      for (const auto& visit : visits) CHECK(visit.load() == 1);
    }
}

TEST_CASE("ParallelFor.ChunksDependOnCountAndGrainOnly") {
  std::vector<std::atomic<std::size_t>> ends(1000);
  parallel_for(1000, 300, [&](std::size_t begin, std::size_t end) { ends[begin] = end; });
  CHECK(ends[0].load() == 300u);
  CHECK(ends[300].load() == 600u);
  CHECK(ends[600].load() == 900u);
  CHECK(ends[900].load() == 1000u);
}

TEST_CASE("ParallelFor.RethrowsAndStops") {
  std::atomic<int> chunks{0};
  CHECK_THROWS_AS(parallel_for(100000, 1,
                               [&](std::size_t begin, std::size_t) {
                                 ++chunks;
                                 if (begin == 10) throw std::runtime_error("here");
                                 // The others leave it the time to be noticed, should its thread be put aside just now.
                                 if (begin > 10) std::this_thread::sleep_for(std::chrono::microseconds(50));
                               }),
                  std::runtime_error);
  CHECK(chunks.load() < 100000);
}

TEST_CASE("ParallelFor.LoopsWithinLoopsVisitEveryIndexOnce") {
  std::vector<std::atomic<int>> visits(64 * 64);
  std::atomic<int> on_other_threads{0};  // assertions belong to one thread
  parallel_for(64, 1, [&](std::size_t begin, std::size_t) {
    const std::thread::id here = std::this_thread::get_id();
    parallel_for(64, 1, [&](std::size_t inner, std::size_t) {
      if (std::this_thread::get_id() != here) ++on_other_threads;
      ++visits[64 * begin + inner];
    });
  });
  CHECK(on_other_threads.load() == 0);  // the threads there are have enough to do
  for (const auto& visit : visits) CHECK(visit.load() == 1);
}

#ifndef __wasm__
TEST_CASE("ParallelFor.SeveralThreadsLoopAtOnce") {
  constexpr int callers = 6, loops = 400;
  std::vector<long> sums(callers);
  std::vector<std::thread> threads;
  for (int caller = 0; caller < callers; ++caller)
    threads.emplace_back([&sums, caller] {
      for (int loop = 0; loop < loops; ++loop) {
        std::vector<int> numbers(static_cast<std::size_t>(200 + loop % 7));
        parallel_for(numbers.size(), 10, [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) numbers[i] = caller + 1;
        });
        sums[static_cast<std::size_t>(caller)] += std::accumulate(numbers.begin(), numbers.end(), 0L);
      }
    });
  for (std::thread& thread : threads) thread.join();
  long each = 0;
  for (int loop = 0; loop < loops; ++loop) each += 200 + loop % 7;
  for (int caller = 0; caller < callers; ++caller) CHECK(sums[static_cast<std::size_t>(caller)] == (caller + 1) * each);
}
#endif

TEST_CASE("ParallelFor.GoesOnAfterPausesAndFailures") {
  // Helpers fall asleep in the pause and wake again; a failure leaves nothing behind.
  for (int round = 0; round < 20; ++round) {
    if (round % 5 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    std::atomic<int> done{0};
    const auto fail = [](std::size_t begin, std::size_t) {
      if (begin == 3) throw std::runtime_error("here");
    };
    CHECK_THROWS_AS(parallel_for(50, 1, fail), std::runtime_error);
    parallel_for(50, 1, [&](std::size_t, std::size_t) { ++done; });
    CHECK(done.load() == 50);
  }
}

TEST_CASE("ParallelFor.TheLimitHolds") {
  std::mutex mutex;
  std::set<std::thread::id> seen;
  const auto look = [&](std::size_t, std::size_t) {
    const std::scoped_lock lock(mutex);
    seen.insert(std::this_thread::get_id());
  };
  {
    const ThreadLimit one(1);
    parallel_for(1000, 1, look);
  }
  CHECK(seen == std::set{std::this_thread::get_id()});
  parallel_for(1000, 1, look);
  CHECK(seen.size() <= static_cast<std::size_t>(thread_count()));
}

#ifdef __linux__
/// A task of a cluster may use one processor of many.
TEST_CASE("AvailableProcessors.AreThoseTheThreadMayRunOn") {
  cpu_set_t all;
  REQUIRE(sched_getaffinity(0, sizeof all, &all) == 0);
  CHECK(available_processors() == CPU_COUNT(&all));
  int first = 0;
  while (!CPU_ISSET(first, &all)) ++first;
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(first, &one);
  REQUIRE(sched_setaffinity(0, sizeof one, &one) == 0);
  CHECK(available_processors() == 1);
  REQUIRE(sched_setaffinity(0, sizeof all, &all) == 0);
}
#endif

}  // namespace
}  // namespace formwright
