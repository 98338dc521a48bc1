// SPDX-License-Identifier: GPL-3.0-or-later
// A cable is pulled in the middle of a job: connecting again, homing and going on from the careful line burns all that
// was not burned.
#include <catch2/matchers/catch_matchers_floating_point.hpp>
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "grbl_talk.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

using Point = std::array<double, 2>;

struct Stroke {
  int line;  // of the file, from 1
  Point from, to;
  double length_mm() const { return std::hypot(to[0] - from[0], to[1] - from[1]); }
};
struct Job {
  std::string text;
  std::vector<Stroke> strokes;
  std::vector<int> travels;  // lines that begin with G0
};

Job random_job(Random& random) {
  Job job;
  int line = 0;
  const auto add = [&](const std::string& text) { job.text += text + "\n", ++line; };
  add("G21G90"), add("M4S500"), add("G0X0Y0"), add("F9000");
  job.travels.push_back(3);
  Point at{0, 0};
  const std::size_t count = 60 + random.below(80);
  const double shortest_mm = random.uniform() < 0.5 ? 0.2 : 5;  // many strokes in the planner at once, or few
  for (std::size_t i = 0; i < count; ++i) {
    const double turn = random.uniform(0, 6.28), far_mm = shortest_mm + random.uniform(0, 10);
    Point to{at[0] + far_mm * std::cos(turn), at[1] + far_mm * std::sin(turn)};
    for (double& x : to) x = std::round(std::clamp(x, 0.0, 60.0) * 1000) / 1000;
    if (to == at) continue;
    if (random.uniform() < 0.1) add("; layer cut part A" + std::to_string(i));
    const bool burns = random.uniform() < 0.75;
    char text[80];
    std::snprintf(text, sizeof text, "G%dX%.3fY%.3f%s", burns ? 1 : 0, to[0], to[1],
                  burns && random.uniform() < 0.2 ? "S300F6000" : "");
    add(text);
    if (burns) job.strokes.push_back({line, at, to});
    else job.travels.push_back(line);
    at = to;
  }
  add("M5"), add("M2");
  return job;
}

/// The length of a stroke that no burn covers.
double left_mm(const Stroke& stroke, const std::vector<VirtualGrbl::Burn>& burns, const Point& origin) {
  const double length = stroke.length_mm(), ux = (stroke.to[0] - stroke.from[0]) / length,
               uy = (stroke.to[1] - stroke.from[1]) / length;
  std::vector<Point> covered;
  for (const auto& burn : burns) {
    std::array<double, 2> along{};
    bool on_it = true;
    for (int end = 0; end < 2; ++end) {
      const auto& p = end ? burn.to_mm : burn.from_mm;
      const double x = p[0] - origin[0] - stroke.from[0], y = p[1] - origin[1] - stroke.from[1];
      along[static_cast<std::size_t>(end)] = x * ux + y * uy;
      on_it = on_it && std::abs(x * uy - y * ux) < 1e-6;
    }
    if (on_it) covered.push_back({std::min(along[0], along[1]), std::max(along[0], along[1])});
  }
  std::sort(covered.begin(), covered.end());
  double reached = 0, left = 0;
  for (const auto& [low, high] : covered) {
    left += std::max(0.0, std::min(low, length) - reached);
    reached = std::max(reached, high);
  }
  return left + std::max(0.0, length - reached);
}

double length_of(const std::vector<VirtualGrbl::Burn>& burns, std::size_t from) {
  double sum = 0;
  for (std::size_t i = from; i < burns.size(); ++i)
    sum += std::hypot(burns[i].to_mm[0] - burns[i].from_mm[0], burns[i].to_mm[1] - burns[i].from_mm[1]);
  return sum;
}

TEST_CASE("GrblGoingOn.AfterPulledCablesEverythingIsBurned") {
  Random random(random_seed() + 7);
  int pulled = 0, in_two_runs = 0;
  for (int round = 0; round < 40; ++round) {
    INFO("seed " + std::to_string(random_seed()) + ", round " + std::to_string(round));
    const Job job = random_job(random);
    GrblTalk talk({}, {.burst_s = random.uniform() < 0.3 ? 0.1 : 0.0}, random.next());
    talk.connect_and_home();
    const Point origin{talk.machine.position_mm()[0], talk.machine.position_mm()[1]};
    talk.load(job.text);
    talk.tell({{"do", "start"}, {"confirmed", true}});
    int from_line = 1, runs = 1;
    std::size_t burns_before = 0;
    for (;; ++runs) {
      const bool pull = runs <= 3;
      const double patience_s = pull ? random.uniform(0.1, 6) : 400;
      if (talk.pass_until([&] { return !talk.ended().empty(); }, patience_s)) break;
      {
        INFO(talk.state().dump());
        REQUIRE(pull);
      }
      ++pulled;
      talk.pull_cable();
      const Json job_state = talk.state()["job"];
      REQUIRE(job_state["ended"] == "cut_off");
      const int careful = job_state["careful_line"];
      // It begins a stroke, or the job, and lies before all that may not be done.
      {
        INFO(careful);
        CHECK((careful == 1 || std::count(job.travels.begin(), job.travels.end(), careful) == 1));
      }
      CHECK(careful <= std::max(1, job_state["line_now"].get<int>()));
      // The machine goes on with what it has, hears no more, and is reset when its port is opened again.
      for (const double end = talk.now_s + random.uniform(0, 2); talk.now_s < end;)
        talk.machine.advance(talk.now_s += 1e-3);
      const double burned_by_then = length_of(talk.machine.burns(), burns_before);
      talk.plug_in();
      talk.connect();
      CHECK_FALSE(talk.state()["position_known"]);
      CHECK_FALSE(talk.can("start"));
      talk.connect_and_home();
      REQUIRE_THAT(talk.machine.position_mm()[0], WithinAbs(origin[0], 1e-9));
      REQUIRE_THAT(talk.machine.position_mm()[1], WithinAbs(origin[1], 1e-9));
      talk.load(job.text);
      in_two_runs += burned_by_then > 0 && careful > from_line;
      burns_before = talk.machine.burns().size();
      from_line = careful;
      talk.tell({{"do", "start"}, {"confirmed", true}, {"from_line", from_line}});
    }
    {
      INFO(talk.state().dump());
      REQUIRE(talk.ended() == "done");
    }
    CHECK(talk.machine.bytes_lost() == 0);
    double again_mm = 0;
    for (const Stroke& stroke : job.strokes) {
      {
        INFO("line " << stroke.line << ", gone on from " << from_line);
        CHECK(left_mm(stroke, talk.machine.burns(), origin) < 1e-5);
      }
      if (stroke.line >= from_line) again_mm += stroke.length_mm();
    }
    // The last run burned what lies behind its careful line, and nothing else.
    CHECK_THAT(length_of(talk.machine.burns(), burns_before), WithinAbs(again_mm, 1e-5));
  }
  CHECK(pulled > 40);
  CHECK(in_two_runs > 20);
}

}  // namespace
}  // namespace formwright
