// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace formwright {
namespace {

TEST(ParallelFor, VisitsEveryIndexOnce) {
  for (const std::size_t count : {0u, 1u, 7u, 1000u, 4097u})
    for (const std::size_t grain : {0u, 1u, 64u, 5000u}) {
      std::vector<std::atomic<int>> visits(count);
      parallel_for(count, grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) ++visits[i];
      });
      for (const auto& visit : visits) EXPECT_EQ(visit.load(), 1);
    }
}

TEST(ParallelFor, ChunksDependOnCountAndGrainOnly) {
  std::vector<std::atomic<std::size_t>> ends(1000);
  parallel_for(1000, 300, [&](std::size_t begin, std::size_t end) { ends[begin] = end; });
  EXPECT_EQ(ends[0].load(), 300u);
  EXPECT_EQ(ends[300].load(), 600u);
  EXPECT_EQ(ends[600].load(), 900u);
  EXPECT_EQ(ends[900].load(), 1000u);
}

TEST(ParallelFor, RethrowsAndStops) {
  std::atomic<int> chunks{0};
  EXPECT_THROW(parallel_for(100000, 1,
                            [&](std::size_t begin, std::size_t) {
                              ++chunks;
                              if (begin == 10) throw std::runtime_error("here");
                            }),
               std::runtime_error);
  EXPECT_LT(chunks.load(), 100000);
}

}  // namespace
}  // namespace formwright
