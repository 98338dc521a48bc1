// SPDX-License-Identifier: GPL-3.0-or-later
// Whatever the line does: the machine's buffer is never overrun, every byte is accounted for, a job is either done
// whole or said not to be.
#include <catch2/matchers/catch_matchers_floating_point.hpp>
#include <cmath>
#include <cstdlib>

#include "grbl_talk.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

std::string random_lines(Random& random, int lines, double& length_mm) {
  std::string job = "G21G90\nM4S500\nG0X0Y0\nF9000\n";
  double x = 0, y = 0;
  length_mm = 0;
  for (int i = 0; i < lines; ++i) {
    const double nx = std::round(random.uniform(0, 30) * 1000) / 1000,
                 ny = std::round(random.uniform(0, 30) * 1000) / 1000;
    const bool burns = random.uniform() < 0.7;
    char line[80];
    if (random.uniform() < 0.05) job += "; layer cut part A" + std::to_string(i) + "\n";
    if (random.uniform() < 0.02) job += "G4P0.05\n";
    std::snprintf(line, sizeof line, random.uniform() < 0.5 ? "G%d X%.3f Y%.3f\n" : "G%dX%.3fY%.3f\n", burns ? 1 : 0,
                  nx, ny);
    job += line;
    if (burns) length_mm += std::hypot(nx - x, ny - y);
    x = nx, y = ny;
  }
  return job + "M5\nM2\n";
}

double burned(const VirtualGrbl& machine) {
  double sum = 0;
  for (const auto& burn : machine.burns())
    sum += std::hypot(burn.to_mm[0] - burn.from_mm[0], burn.to_mm[1] - burn.from_mm[1]);
  return sum;
}

TEST_CASE("GrblProperty.JobsArriveWholeOverSlowAndBurstyLines") {
  Random random(random_seed());
  for (int round = 0; round < 12; ++round) {
    INFO("seed " + std::to_string(random_seed()) + ", round " + std::to_string(round));
    double length = 0;
    const std::string job = random_lines(random, 40 + static_cast<int>(random.below(80)), length);
    GrblTalk talk({}, {.burst_s = random.uniform() < 0.5 ? 0.0 : random.uniform(0, 0.2)}, random.next());
    talk.connect_and_home();
    talk.load(job);
    talk.tell({{"do", "start"}, {"confirmed", true}});
    {
      const bool reached = talk.pass_until(
          [&] {
            CHECK(talk.machine.bytes_lost() == 0);
            if (random.uniform() < 0.001)
              talk.refusal({{"do", "override"}, {"feed_percent", 80 + static_cast<double>(random.below(60))}});
            if (talk.phase() == "paused") talk.tell({{"do", "resume"}, {"confirmed", true}});
            else if (random.uniform() < 0.002) talk.refusal({{"do", "pause"}});
            return !talk.ended().empty();
          },
          400);
      INFO(talk.state().dump());
      REQUIRE(reached);
      CHECK(talk.ended() == "done");
    }
    CHECK_THAT(burned(talk.machine), WithinAbs(length, 1e-6 * length));
  }
}

TEST_CASE("GrblProperty.WhateverHappensTheQueueEndsAndTheBeamGoesOut") {
  Random random(random_seed() + 1);
  int done = 0, not_done = 0;
  for (int round = 0; round < 40; ++round) {
    INFO("seed " + std::to_string(random_seed()) + ", round " + std::to_string(round));
    double length = 0;
    const std::string job = random_lines(random, 60, length);
    VirtualGrblOptions options;
    options.soft_limits = random.uniform() < 0.3;
    GrblTalk talk(options, {}, random.next());
    talk.connect_and_home();
    talk.load(job);
    talk.tell({{"do", "start"}, {"confirmed", true}});
    talk.pass(random.uniform(0, 4));
    switch (random.below(6)) {
      case 0: talk.machine.trip_limit(); break;
      case 1: talk.machine.brown_out(talk.now_s); break;
      case 2: talk.machine.refuse_next(1 + static_cast<int>(random.below(38))); break;
      case 3: talk.tell({{"do", "stop"}}); break;
      case 4:
        talk.driver.closed(talk.now_s), talk.machine.receive("\x18", talk.now_s), talk.driver.opened(talk.now_s);
        break;
      default: break;
    }
    {
      const bool reached = talk.pass_until([&] { return !talk.ended().empty() || talk.state()["job"].is_null(); }, 100);
      INFO(talk.state().dump());
      REQUIRE(reached);
    }
    CHECK(talk.machine.bytes_lost() == 0);
    talk.pass(3);
    CHECK_FALSE(talk.machine.beam());
    const auto there = talk.machine.position_mm();
    const std::size_t lines = talk.machine.lines().size();
    talk.pass(3);
    CHECK(talk.machine.position_mm() == there);
    for (std::size_t i = lines; i < talk.machine.lines().size(); ++i)
      CHECK(talk.machine.lines()[i].substr(0, 1) == "$");
    if (talk.ended() == "done") {
      ++done;
      CHECK_THAT(burned(talk.machine), WithinAbs(length, 1e-6 * length));
    } else {
      ++not_done;
      CHECK_FALSE(talk.state()["position_known"]);
    }
  }
  CHECK(done > 0);
  CHECK(not_done > 10);
}

TEST_CASE("GrblProperty.LostBytesNeverPassForADoneJob") {
  Random random(random_seed() + 2);
  int caught = 0;
  for (int round = 0; round < 30; ++round) {
    INFO("seed " + std::to_string(random_seed()) + ", round " + std::to_string(round));
    double length = 0;
    const std::string job = random_lines(random, 60, length);
    // Bytes lost on the way back: answers are missing, and the driver must not wait for ever nor take the job for done.
    GrblTalk talk({}, {.lose_to_host = 0.0015}, random.next());
    if (!talk.pass_until([&] { return talk.state()["connection"] == "ready"; }, 60)) continue;
    if (!talk.refusal({{"do", "home"}, {"confirmed", true}}).empty()) continue;
    if (!talk.pass_until([&] { return talk.state()["position_known"] == true && talk.phase() == "idle"; }, 20))
      continue;
    talk.tell({{"do", "jog"}, {"x_mm", -300}, {"y_mm", -300}, {"speed_mm_per_s", 150}});
    talk.pass(6);
    talk.refusal({{"do", "set_origin"}, {"axes", "xy"}});
    talk.pass(1);
    talk.load(job);
    if (!talk.refusal({{"do", "start"}, {"confirmed", true}}).empty()) continue;
    {
      const bool reached = talk.pass_until([&] { return !talk.ended().empty(); }, 400);
      INFO(talk.state().dump());
      REQUIRE(reached);
    }
    CHECK(talk.machine.bytes_lost() == 0);
    if (talk.ended() != "done") {
      ++caught;
      continue;
    }
    CHECK_THAT(burned(talk.machine), WithinAbs(length, 1e-6 * length));
  }
  CHECK(caught > 0);
}

TEST_CASE("GrblProperty.TenThousandShortSegmentsDoNotStarve") {
  VirtualGrblOptions options;
  options.acceleration_mm_per_s2 = 5000;
  GrblTalk talk(options);
  talk.connect_and_home();
  // 10,000 segments of 0.5 mm at 100 mm/s: 200 lines a second; at 115200 baud 11,520 bytes a second.
  std::string job = "G21G90\nM4S500\nG1F6000\n";
  for (int i = 1; i <= 10000; ++i) {
    char line[40];
    const double angle = i * 0.5 / 40;
    std::snprintf(line, sizeof line, "X%.3fY%.3f\n", 50 + 40 * std::cos(angle), 50 + 40 * std::sin(angle));
    job += line;
  }
  talk.load(job + "M5\n");
  talk.tell({{"do", "start"}, {"confirmed", true}});
  talk.pass(3);
  const int dry_at_start = talk.machine.planner_ran_dry();
  const double began = talk.now_s;
  const long bytes_before = talk.bytes_sent;
  REQUIRE(talk.pass_until([&] { return talk.state()["job"]["acknowledged"] > 9900; }, 200));
  CHECK(talk.machine.planner_ran_dry() == dry_at_start);
  CHECK(talk.machine.bytes_lost() == 0);
  CHECK(talk.now_s - began < 52);
  CHECK(talk.bytes_sent - bytes_before > 100000);
  SUCCEED("seconds " << static_cast<int>(talk.now_s - began));
}

}  // namespace
}  // namespace formwright
