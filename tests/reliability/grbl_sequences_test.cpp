// SPDX-License-Identifier: GPL-3.0-or-later
// Random sequences at a GRBL laser: FORMWRIGHT_SEQUENCES (60) and FORMWRIGHT_SEED choose how many, and which.
#include <catch2/catch_test_macros.hpp>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "reliability/grbl_sequence.h"

namespace formwright {
namespace {
using namespace reliability_test;

std::uint64_t number_from(const char* name, std::uint64_t otherwise) {
  const char* given = std::getenv(name);
  return given ? std::strtoull(given, nullptr, 10) : otherwise;
}

TEST_CASE("GrblSequences.TheBeamIsOnNowhereButInStrokes") {
  const std::uint64_t seed = number_from("FORMWRIGHT_SEED", 20261125), count = number_from("FORMWRIGHT_SEQUENCES", 60);
  Totals totals;
  for (std::uint64_t i = 0; i < count; ++i) {
    INFO("FORMWRIGHT_SEED=" + std::to_string(seed + i) + " FORMWRIGHT_SEQUENCES=1");
    Sequence(seed + i, totals).run();
  }
  std::printf(
      "%llu sequences from seed %llu: %d orders (%d refused), %d faults, %d kills; %d jobs begun, %d done\n"
      "beam on: %.1f s in strokes, %.1f s focus light, %.3f s elsewhere; farthest from a stroke %.4f mm\n"
      "focus light after a kill: at most %.2f s; jobs that left their bounds: %d\n",
      static_cast<unsigned long long>(count), static_cast<unsigned long long>(seed), totals.orders, totals.refused,
      totals.faults, totals.kills, totals.jobs, totals.done, totals.strokes_s, totals.focus_s, totals.elsewhere_s,
      totals.farthest_mm, totals.longest_focus_after_kill_s, totals.left_bounds);
  CHECK(totals.elsewhere_s == 0);
  CHECK(totals.left_bounds == 0);
  CHECK(totals.longest_focus_after_kill_s <= 1.2);
  if (count >= 60) {
    CHECK(totals.jobs > static_cast<int>(count) / 2);
    CHECK(totals.kills > static_cast<int>(count) / 10);
    CHECK(totals.strokes_s > static_cast<double>(count));
    CHECK(totals.focus_s > 1);
  }
}

}  // namespace
}  // namespace formwright
