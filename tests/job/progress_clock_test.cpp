// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/progress/progress_clock.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <chrono>
#include <cmath>
#include <numeric>
#include <thread>
#include <vector>

#include "job/catalog.h"
#include "job/progress/alike_runs.h"
#include "job/progress/timed_host.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

/// Most of the time passes while 0.3 is reported, and hardly any between 0.5 and 0.9.
TimeShares uneven() {
  TimeShares shares{};
  for (std::size_t k = 0; k < shares.size(); ++k) shares[k] = k == 30 ? 60 : k >= 50 && k < 90 ? 0.1 : 1;
  const double sum = std::accumulate(shares.begin(), shares.end(), 0.0);
  for (double& share : shares) share /= sum;
  return shares;
}

/// What a run says that takes `seconds` for each hundredth: every 10 ms, in a long run 5,000 times.
struct Moment {
  double at_s;
  ProgressClock::Estimate said;
};
std::vector<Moment> follow(ProgressClock& clock, const TimeShares& seconds) {
  const double step = std::max(0.01, std::accumulate(seconds.begin(), seconds.end(), 0.0) / 5000);
  std::vector<Moment> moments;
  double now = 0;
  for (std::size_t k = 0; k < seconds.size(); ++k) {
    clock.report(0.01 * static_cast<double>(k), now);
    const double end = now + seconds[k];
    for (; now < end; now = std::min(end, now + step)) moments.push_back({now, clock.at(now)});
  }
  return moments;
}

TimeShares times(const TimeShares& shares, double seconds) {
  TimeShares result = shares;
  for (double& share : result) share *= seconds;
  return result;
}

TEST_CASE("ProgressClock.ARunLikeTheUsualOneIsForetoldExactly") {
  for (const double seconds : {5.0, 40.0, 3000.0}) {
    ProgressClock clock({uneven()});
    int given = 0, count = 0;
    for (const auto& [at, said] : follow(clock, times(uneven(), seconds))) {
      // The first hundredth is finished before the speed is known.
      if (at > 0.02 * seconds && at < seconds - 0.02) CHECK_THAT(said.passed, WithinAbs(at / seconds, 1e-6));
      ++count;
      if (!said.seconds_left) continue;
      ++given;
      CHECK_THAT(*said.seconds_left, WithinAbs(std::max(seconds - at, 0.5), 1e-6 * seconds));
    }
    CHECK(given > (seconds > 10 ? 0.9 : 0.5) * count);
  }
}

TEST_CASE("ProgressClock.ASpeedThatChangesIsFollowed") {
  // From the middle on everything takes three times as long.
  TimeShares seconds = times(uneven(), 20);
  double before = 0;
  for (std::size_t k = 0; k < seconds.size(); ++k) {
    before += seconds[k];
    if (before > 12) seconds[k] *= 3;
  }
  const double all = std::accumulate(seconds.begin(), seconds.end(), 0.0);
  ProgressClock clock({uneven()});
  double last = 0;
  for (const auto& [at, said] : follow(clock, seconds)) {
    CHECK(said.passed >= last);
    CHECK(said.passed <= 1);
    CHECK(std::isfinite(said.passed));
    last = said.passed;
    if (said.seconds_left) CHECK(*said.seconds_left <= all);
  }
  CHECK(last > 0.95);
}

TEST_CASE("ProgressClock.WhatWasKeptFromBeforeSaysNothingOfTheSpeed") {
  // The sixty parts of a hundred that usually pass at 0.3 were found again: they take no time.
  TimeShares seconds = times(uneven(), 50);
  seconds[30] = 0;
  const double all = std::accumulate(seconds.begin(), seconds.end(), 0.0);
  ProgressClock clock({uneven()});
  int given = 0;
  for (const auto& [at, said] : follow(clock, seconds))
    if (said.seconds_left && at > 0.5 * all) {
      CHECK_THAT(*said.seconds_left, WithinAbs(all - at, 0.02 * all));
      ++given;
    }
  CHECK(given > 100);  // of 1,000 moments in that half
}

TEST_CASE("ProgressClock.NoFigureWhileAPartTakesFarLongerThanUsual") {
  TimeShares seconds = times(uneven(), 10);
  seconds[40] = 100;
  double begin = 0;
  for (std::size_t k = 0; k < 40; ++k) begin += seconds[k];
  ProgressClock clock({uneven()});
  for (const auto& [at, said] : follow(clock, seconds))
    if (at > begin + 2 && at < begin + 100) {
      CHECK_FALSE(said.seconds_left);
      CHECK(said.passed < 0.9);
    }
}

/// Shares that are even up to 0.5, where `first` of the time has passed, and even from there on.
TimeShares halves(double first) {
  TimeShares shares{};
  for (std::size_t k = 0; k < shares.size(); ++k) shares[k] = (k < 50 ? first : 1 - first) / 50;
  return shares;
}

TEST_CASE("ProgressClock.RunsThatDisagreeGiveNoFigureUntilTheyAgree") {
  // Both earlier runs look alike up to the middle; then three quarters of the time remain, or a quarter.
  ProgressClock clock({halves(0.25), halves(0.75)});
  int early = 0, late = 0;
  for (const auto& [at, said] : follow(clock, times(halves(0.25), 100))) {
    if (!said.seconds_left) continue;
    if (at < 25) ++early;
    else ++late;
    if (at > 60) CHECK_THAT(*said.seconds_left, WithinRel(std::max(100 - at, 0.5), 0.5));
  }
  CHECK(early == 0);
  CHECK(late > 1000);  // of 3,750 moments
}

TEST_CASE("ProgressClock.TheRunThatIsLikeThisOneCounts") {
  // Of the others half of the time passes at 0.03, where this one is soon gone on.
  TimeShares other{};
  for (std::size_t k = 0; k < other.size(); ++k) other[k] = k == 3 ? 0.505 : 0.005;
  ProgressClock clock({other, uneven(), other, other});
  int given = 0;
  for (const auto& [at, said] : follow(clock, times(uneven(), 100)))
    if (at > 65 && said.seconds_left) {
      CHECK_THAT(*said.seconds_left, WithinRel(std::max(100 - at, 0.5), 0.2));
      ++given;
    }
  CHECK(given > 1100);  // of 1,750 moments
}

TEST_CASE("ProgressClock.AnOperationThatWasNeverMeasuredHasAShareButNoRemainingTime") {
  ProgressClock clock(usual_time_shares("no such operation"));
  TimeShares even;
  even.fill(0.2);
  for (const auto& [at, said] : follow(clock, even)) {
    CHECK_FALSE(said.seconds_left);
    if (at > 0.4) CHECK_THAT(said.passed, WithinAbs(at / 20, 0.01));
  }
}

TEST_CASE("ProgressClock.MeasuresHowTheTimeWasSpent") {
  ProgressClock clock(usual_time_shares("no such operation"));
  follow(clock, times(uneven(), 30));
  const TimeShares measured = clock.measured(30);
  double sum = 0;
  for (std::size_t k = 0; k < measured.size(); ++k) {
    CHECK_THAT(measured[k], WithinAbs(uneven()[k], 1e-9));
    sum += measured[k];
  }
  CHECK_THAT(sum, WithinRel(1.0, 1e-9));
  // A run that is over at once, and one whose fractions are out of range.
  CHECK_THAT(ProgressClock({uneven()}).measured(0)[7], WithinAbs(0.01, 1e-12));
  ProgressClock wild({uneven()});
  wild.report(7, 1);
  wild.report(-3, 2);
  CHECK(wild.at(2).passed <= 1);
}

TEST_CASE("ProgressClock.UsualSharesAddUpToOne") {
  for (const char* name : {"relief", "thermoform-simulate", "zippable-design", "evidence-diagnose"}) {
    INFO(name);
    const std::vector<TimeShares> runs = usual_time_shares(name);
    CHECK(!runs.empty());
    for (const TimeShares& shares : runs) {
      CHECK_THAT(std::accumulate(shares.begin(), shares.end(), 0.0), WithinRel(1.0, 1e-9));
      for (const double share : shares) CHECK(share >= 0);
    }
  }
}

TEST_CASE("AlikeRuns.NamesTheSwitchesThatAreNotAsUsual") {
  const Operation* diagnose = find_operation("evidence-diagnose");
  REQUIRE(diagnose);
  CHECK(alike_runs(*diagnose, Json::object()) == "evidence-diagnose");
  CHECK(alike_runs(*diagnose, {{"triangles", 700}, {"pairs", true}}) == "evidence-diagnose");
  CHECK(alike_runs(*diagnose, {{"pairs", false}}) == "evidence-diagnose pairs=false");
  const Operation* relief = find_operation("relief");
  REQUIRE(relief);
  CHECK(alike_runs(*relief, {{"appearance", "balanced"}, {"width_mm", 70}}) == "relief appearance=balanced");
  CHECK(alike_runs(*relief, {{"appearance", 7}}) == "relief");
  CHECK(alike_runs(*relief, Json::array()) == "relief");
  // Runs that nobody measured with a switch are compared with those without it.
  CHECK(usual_time_shares("relief no_such=true").size() == usual_time_shares("relief").size());
  CHECK(usual_time_shares("evidence-diagnose pairs=false") != usual_time_shares("evidence-diagnose"));
}

TEST_CASE("TimedHost.SpeaksWhileTheJobOnlyAsksWhetherToEndAndLearnsFromIt") {
  Session session;
  std::vector<Progress> said;
  bool cancel = false;
  const Host host{[&](const Progress& p) { said.push_back(p); }, [&] { return cancel; }, {}};
  TimedHost timed(host, "a test", session);
  Context context(timed.host());
  context.progress(0.1, "Reading");
  context.progress(0.5, "Solving");
  const std::size_t before = said.size();
  const Stopwatch watch;
  while (watch.seconds() < 1.1) {
    context.check_cancelled();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  CHECK(said.size() >= before + 2);
  CHECK(said.back().stage == "Solving");
  CHECK(learned_time_shares("a test", session) == nullptr);
  timed.succeeded();
  const auto learned = learned_time_shares("a test", session);
  REQUIRE(learned);
  REQUIRE(learned->size() == 1);
  CHECK(learned->front()[50] > 0.9);
  cancel = true;
  CHECK(context.cancelled());
}

}  // namespace
}  // namespace formwright
