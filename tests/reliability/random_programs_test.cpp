// SPDX-License-Identifier: GPL-3.0-or-later
// Random programs over all that a dialect has: each is refused with a sentence that names a line, or every place that
// an interpreter of its own goes to lies within the bounds that were announced, and reaches them.
// FORMWRIGHT_SEED and FORMWRIGHT_PROGRAMS choose other and more of them.
#include <catch2/benchmark/catch_benchmark.hpp>
#include <catch2/catch_test_macros.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "base/error.h"
#include "machines/gcode/gcode_rules.h"
#include "reliability/random_program.h"
#include "reliability/rs274_interpreter.h"

namespace formwright {
namespace {

constexpr double tolerance_mm = 1e-3;

long number_from_environment(const char* name, long otherwise) {
  const char* text = std::getenv(name);
  return text != nullptr ? std::atol(text) : otherwise;
}

TEST_CASE("RandomPrograms.StayWithinTheirBoundsOrAreRefused") {
  const long seed = number_from_environment("FORMWRIGHT_SEED", 20),
             count = number_from_environment("FORMWRIGHT_PROGRAMS", 200);
  Random random(static_cast<std::uint64_t>(seed));
  long refused = 0, run = 0, places = 0;
  double farthest_mm = 0, farthest_short_mm = 0;
  for (long n = 0; n < count; ++n) {
    const bool marlin = n % 4 == 3, hostile = random.below(3) == 0;
    const std::string text = Author(random, marlin).program(hostile);
    INFO("seed " + std::to_string(seed) + ", program " + std::to_string(n) + ":\n" + text);
    GcodeProgram program;
    try {
      program = GcodeProgram::read(as_bytes(text), 96, marlin);
      require_runnable(program, {marlin ? GcodeDialect::marlin : GcodeDialect::grbl});
    } catch (const Error& error) {
      const std::string sentence = error.what();
      {
        INFO(sentence);
        CHECK(hostile);
        CHECK((sentence.starts_with("Line ") && sentence.ends_with('.')));
      }
      ++refused;
      continue;
    }
    CHECK_FALSE(hostile);
    ++run;
    Place head{random.uniform(-90, 90), random.uniform(-90, 90), 0};
    if (program.from_here()) head = {0, 0, 0};
    Interpreter interpreter(head);
    interpreter.run(text);
    places += interpreter.places;
    const GcodeBounds& bounds = program.bounds();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      {
        INFO("axis " << axis);
        REQUIRE(bounds.named[axis] == interpreter.named[axis]);
      }
      if (!bounds.named[axis]) continue;
      const double outside =
          std::max(bounds.low_mm[axis] - interpreter.low[axis], interpreter.high[axis] - bounds.high_mm[axis]);
      const double left =
          std::max(interpreter.low[axis] - bounds.low_mm[axis], bounds.high_mm[axis] - interpreter.high[axis]);
      farthest_mm = std::max(farthest_mm, outside);
      farthest_short_mm = std::max(farthest_short_mm, left);
      {
        INFO("axis " << axis);
        CHECK(outside <= tolerance_mm);
      }
      INFO("the bounds are too wide on axis " << axis);
      CHECK(left <= tolerance_mm);
    }
  }
  std::printf(
      "seed %ld: %ld programs refused, %ld run, %ld places, farthest outside %.2g mm, bounds too wide by %.2g mm\n",
      seed, refused, run, places, farthest_mm, farthest_short_mm);
  CHECK(run > count / 3);
  CHECK(refused > count / 6);
}

/// FORMWRIGHT_JOB_MB (4) megabytes of strokes; a sender takes 114 at most.
std::string large_job() {
  const auto bytes = static_cast<std::size_t>(number_from_environment("FORMWRIGHT_JOB_MB", 4)) * 1'000'000;
  Random random(3);
  std::string text = "G21\nG90\nG0X0Y0\nM4S0\n";
  text.reserve(bytes + 100);
  char line[64];
  while (text.size() < bytes) {
    std::snprintf(line, sizeof line, "G1 X%.3f Y%.3f S%d F3000\n", random.uniform(0, 400), random.uniform(0, 300),
                  static_cast<int>(random.below(1000)));
    text += line;
  }
  return text;
}

double power_before_a_random_line(const GcodeProgram& program, Random& random) {
  return program.state_before(static_cast<int>(random.below(static_cast<std::size_t>(program.line_count())))).power;
}

TEST_CASE("RandomPrograms.LargeJobsAreReadInOnePassAndLookedUpAtOnce") {
  const std::string text = large_job();
  const GcodeProgram program = GcodeProgram::read(as_bytes(text), 78);
  require_runnable(program, {});
  Random random(4);
  double sum = 0;
  for (int i = 0; i < 1000; ++i) sum += power_before_a_random_line(program, random);
  CHECK(sum > 0);
  CHECK(program.memory_bytes() < text.size() * 3 / 2);
}

/// Hidden, for it has nothing to fail by: test_random_programs '[!benchmark]' --benchmark-samples 5
TEST_CASE("RandomPrograms.SecondsOfLargeJobs", "[!benchmark]") {
  const std::string text = large_job();
  const GcodeProgram program = GcodeProgram::read(as_bytes(text), 78);
  Random random(4);
  BENCHMARK("read") { return GcodeProgram::read(as_bytes(text), 78).line_count(); };
  BENCHMARK("rules") { return require_runnable(program, {}); };
  BENCHMARK("state before a line") { return power_before_a_random_line(program, random); };
}

}  // namespace
}  // namespace formwright
