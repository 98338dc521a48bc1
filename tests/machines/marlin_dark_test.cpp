// SPDX-License-Identifier: GPL-3.0-or-later
// A Marlin laser shines on its job's cuts and on the focus spot, and nowhere else: FORMWRIGHT_SEQUENCES (40) random
// sequences of orders, faults and dead hosts; FORMWRIGHT_SEED draws others.
#include <catch2/catch_test_macros.hpp>

#include <cstdio>
#include <cstdlib>

#include "machines/marlin_laser_talk.h"

namespace formwright {
namespace {

constexpr double bed_x_mm = 300, bed_y_mm = 200;

std::string number(double value) { return machines_detail::decimal(value); }

/// A few cuts of one to four lines. `cut_off`: the file ends behind a cut, and nothing turns the laser off.
LaserJob random_laser_job(Random& random, LaserJob::Mode mode, bool cut_off) {
  LaserJob job;
  job.mode = mode;
  const double width = 5 + 40 * random.uniform(), height = 5 + 40 * random.uniform();
  job.bounds_mm = {0, 0, width, height};
  const auto place = [&] {
    return std::array{std::round(1e3 * width * random.uniform()) / 1e3,
                      std::round(1e3 * height * random.uniform()) / 1e3};
  };
  const bool standard = mode == LaserJob::Mode::standard;
  std::string text = random.uniform() < 0.5 ? "G21\nG90\n" : "";
  bool on = false;
  for (std::size_t cuts = 1 + random.below(4); cuts > 0; --cuts) {
    auto at = place();
    text += "G0 X" + number(at[0]) + " Y" + number(at[1]) + " F6000\n";
    if (!on && !standard) text += mode == LaserJob::Mode::dynamic ? "M4 I\n" : "M3 I\n", on = true;
    if (standard) text += "M3 S200\n";
    for (std::size_t lines = 1 + random.below(4), i = 0; i < lines; ++i) {
      const auto to = place();
      text += "G1 X" + number(to[0]) + " Y" + number(to[1]);
      if (i == 0) text += (standard ? "" : " S200") + std::string(" F") + number(1500 + 3000 * random.uniform());
      text += "\n";
      job.cuts_mm.push_back({at[0], at[1], to[0], to[1]});
      at = to;
    }
    if (cuts == 1 && cut_off) break;
    if (standard) text += "M5\n";
  }
  if (!cut_off) text += std::string(standard ? "" : "M5 I\n") + "M5\nG0 X0 Y0 F6000\n";
  job.text = text;
  return job;
}

struct Sums {
  double outside_s = 0, killed_rest_s = 0, killed_dynamic_s = 0, max_rest_s = 0, max_dynamic_rest_s = 0, lit_s = 0,
         spot_s = 0, outside_bed_mm = 0;
  int orders = 0, refused = 0, faults = 0, kills = 0, jobs = 0, done = 0;
};

class Sequence {
 public:
  Sequence(std::uint64_t seed, Sums& sums)
      : random_(seed), sums_(sums), mode_(static_cast<LaserJob::Mode>(seed % 3)), talk_(machine_options(), seed, 4) {}

  std::string run() {
    talk_.wait_for("idle", 10);
    for (int i = 0; i < 14 && talk_.outside_s == 0; ++i) {
      if (random_.uniform() < 0.75) order();
      else fault();
    }
    talk_.pass(5);
    sums_.outside_s += talk_.outside_s;
    sums_.killed_rest_s += talk_.killed_rest_s;
    sums_.killed_dynamic_s += talk_.killed_dynamic_s;
    double& rest_s = mode_ == LaserJob::Mode::dynamic ? sums_.max_dynamic_rest_s : sums_.max_rest_s;
    rest_s = std::max(rest_s, talk_.max_rest_s);
    sums_.lit_s += talk_.lit_s;
    sums_.spot_s += talk_.spot_s;
    sums_.outside_bed_mm = std::max(sums_.outside_bed_mm, talk_.outside_bed_mm);
    return talk_.outside_s > 0 || talk_.killed_dynamic_s > 0 || talk_.outside_bed_mm > 0.01 ? log_ + talk_.first_outside
                                                                                            : "";
  }

 private:
  VirtualMarlinOptions machine_options() {
    VirtualMarlinOptions options;
    // Firmware without inline modes: such jobs stay dark on it.
    options.inline_modes = mode_ == LaserJob::Mode::dynamic || random_.uniform() < 0.6;
    options.safety_timeout = options.inline_modes && random_.uniform() < 0.5;
    options.emergency_parser = random_.uniform() < 0.5;
    options.advanced_ok = random_.uniform() < 0.5;
    options.bed_mm = {bed_x_mm, bed_y_mm, 50};
    return options;
  }
  void log(const std::string& what) { log_ += number(talk_.machine.now_s()) + " " + what + "; "; }

  bool tell(const Json& command) {
    const bool taken = talk_.try_tell(command);
    log(command["do"].get<std::string>() + (taken ? "" : " (refused)"));
    ++(taken ? sums_.orders : sums_.refused);
    return taken;
  }
  void wait() { talk_.pass(random_.uniform() < 0.5 ? 0.3 * random_.uniform() : 5 * random_.uniform()); }

  /// Until the head rests, so that the spot is known.
  void rest() {
    for (int i = 0; i < 2000 && (talk_.machine.moves() || talk_.phase() == "jogging" || talk_.phase() == "homing"); ++i)
      talk_.pass(0.01);
    talk_.pass(0.1);
  }

  void order() {
    const std::size_t which = random_.below(12);
    if (which == 0 || (which < 9 && !talk_.state()["position_known"].get<bool>() && talk_.can("home"))) home();
    else if (which == 1) tell({{"do", "jog"}, {"x_mm", 10 * random_.uniform()}, {"y_mm", 3}, {"speed_mm_per_s", 30}});
    else if (which == 2)
      tell({{"do", "go_to"},
            {"x_mm", 100 * random_.uniform()},
            {"y_mm", 100 * random_.uniform()},
            {"speed_mm_per_s", 80}});
    else if (which == 3)
      tell({{"do", "frame"},
            {"bounds_mm", {0, 0, 30 * random_.uniform(), 30}},
            {"speed_mm_per_s", 100},
            {"confirmed", true}});
    else if (which == 4) focus();
    else if (which == 5) tell({{"do", "focus_off"}});
    else if (which == 6) by_hand();
    else if (which == 7) {
      rest();
      if (tell({{"do", "set_origin"}})) talk_.job = {};
      talk_.pass(0.3);  // the origin moves with a line of its own
    } else start();
    wait();
  }

  void home() {
    if (!tell({{"do", "home"}, {"confirmed", true}})) return;
    if (random_.uniform() < 0.8) talk_.wait_for("idle", 30);
  }
  void focus() {
    rest();
    if (!talk_.can("focus")) return;
    talk_.expect_spot(true);
    tell({{"do", "focus"}, {"power_percent", 1}, {"confirmed", true}});
  }
  void by_hand() {
    rest();
    if (!talk_.can("send")) return;
    talk_.expect_spot(false);
    tell({{"do", "send"}, {"line", random_.uniform() < 0.5 ? "M3 S30" : "M3 I S30"}, {"confirmed", true}});
    wait();
  }
  void start() {
    LaserJob job = random_laser_job(random_, mode_, random_.uniform() < 0.5);
    try {
      talk_.driver.load("job", as_bytes(job.text));
    } catch (const Error&) {
      return;  // one runs
    }
    if (!tell({{"do", "start"}, {"confirmed", true}})) return;
    talk_.job = std::move(job);
    ++sums_.jobs;
    const std::size_t how = random_.below(4);
    if (how == 0) return;
    talk_.pass(4 * random_.uniform());
    if (how == 1 && tell({{"do", "pause"}})) {
      talk_.pass(3 * random_.uniform());
      tell({{"do", "resume"}, {"confirmed", true}});
    }
    if (how == 2) tell({{"do", "stop"}});
    for (int i = 0; i < 600 && talk_.state()["job"].is_object() && talk_.state()["job"]["ended"].is_null(); ++i)
      talk_.pass(0.1);
    const Json state = talk_.state();
    sums_.done += state["job"].is_object() && state["job"]["ended"] == "done";
  }

  void fault() {
    ++sums_.faults;
    const std::size_t which = random_.below(5);
    if (which == 0) {
      log("noise");
      talk_.machine.spoil = 0.3;
      wait();
      order();
      talk_.machine.spoil = 0;
    } else if (which == 1) {
      log("cable out for a while");
      talk_.cable = false;
      talk_.pass(2 * random_.uniform());
      talk_.cable = true;
    } else if (which == 2) {
      log("brown-out");
      talk_.machine.restart();
      talk_.homed_before = 0;
    } else if (which == 3) {
      log("cable pulled, another session");
      talk_.cable = false;
      talk_.kill_host(random_);
      attach();
    } else {
      log("host dies");
      ++sums_.kills;
      talk_.kill_host(random_);
      attach();
    }
    wait();
  }
  void attach() {
    talk_.pass(20 * random_.uniform());
    talk_.attach(random_.uniform() < 0.5);
    talk_.wait_for("idle", 12);
    talk_.job = {};
  }

  Random random_;
  Sums& sums_;
  LaserJob::Mode mode_;
  MarlinLaserTalk talk_;
  std::string log_;
};

TEST_CASE("MarlinDark.NothingShinesBesideCutsAndSpotsInRandomSequences") {
  const char* count_text = std::getenv("FORMWRIGHT_SEQUENCES");
  const char* seed_text = std::getenv("FORMWRIGHT_SEED");
  const int count = count_text ? std::atoi(count_text) : 40;
  const std::uint64_t first = seed_text ? std::strtoull(seed_text, nullptr, 10) : 1;
  Sums sums;
  for (int i = 0; i < count; ++i) {
    const std::uint64_t seed = first + static_cast<std::uint64_t>(i);
    const std::string wrong = Sequence(seed, sums).run();
    {
      INFO("seed " << seed);
      CHECK(wrong == "");
    }
    if (!wrong.empty()) break;
  }
  std::printf(
      "Marlin, %d sequences from seed %llu: %d orders taken, %d refused, %d faults, %d dead hosts, %d jobs begun, %d "
      "done.\nBeam on for %.0f s, %.0f s of it on focus spots. Outside cuts and spots: %.3f s. Behind dead hosts at "
      "rest: %.3f s with M4 I or focus; %.1f s with M3 (I or not), which the firmware does not end by itself.\nLongest "
      "at rest on a cut while the host lives: %.2f s with M4 I, %.2f s with M3.\n",
      count, static_cast<unsigned long long>(first), sums.orders, sums.refused, sums.faults, sums.kills, sums.jobs,
      sums.done, sums.lit_s, sums.spot_s, sums.outside_s, sums.killed_dynamic_s, sums.killed_rest_s,
      sums.max_dynamic_rest_s, sums.max_rest_s);
  CHECK(sums.outside_s == 0);
  CHECK(sums.killed_dynamic_s == 0);
  CHECK(sums.done > count / 8);
  CHECK(sums.lit_s > count / 4.0);
}

}  // namespace
}  // namespace formwright
