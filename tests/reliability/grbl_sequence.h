// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A random sequence of orders, faults and killed programs at a GRBL laser. Its log is the judge: whenever the beam was
// on, the head was on a stroke of a job that was started, or it was the focus light at the place it was asked for.
#include <catch2/catch_test_macros.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "machines/grbl_talk.h"
#include "reliability/random_laser_job.h"

namespace formwright::reliability_test {

inline constexpr double tolerance_mm = 0.01, alone_s = 60, focus_power = 20;

struct Totals {
  int jobs = 0, done = 0, kills = 0, orders = 0, refused = 0, faults = 0, left_bounds = 0;
  double strokes_s = 0, focus_s = 0, elsewhere_s = 0, farthest_mm = 0, longest_focus_after_kill_s = 0;
};

inline VirtualGrblOptions random_machine(Random& random, std::uint64_t seed) {
  VirtualGrblOptions options;
  options.homes = random.uniform() < 0.7;
  options.origin_low = random.uniform() < 0.5;
  options.resets_on_open = random.uniform() < 0.5;
  options.soft_limits = options.homes && random.uniform() < 0.3;
  if (random.uniform() < 0.4) options.planner_blocks = 35, options.rx_bytes = 1024;
  options.error_latch = random.uniform() < 0.4;
  options.grblhal = Random(seed + 1).uniform() < 0.3;  // drawn apart, so that older seeds keep their sequences
  options.homing_s = 0.5;
  options.acceleration_mm_per_s2 = random.uniform() < 0.5 ? 500 : 2000;
  return options;
}

class Sequence {
 public:
  Sequence(std::uint64_t seed, Totals& totals)
      : random_(seed), totals_(totals), talk_(random_machine(random_, seed), {}, seed) {
    if (random_.uniform() < 0.2) talk_.machine.set_setting(13, 1);
    talk_.machine.set_setting(10, static_cast<double>(random_.below(4)));
    if (random_.uniform() < 0.2) talk_.machine.set_setting(30, 1000), talk_.machine.set_setting(31, 5);
  }

  void run() {
    make_ready();
    for (std::size_t count = 6 + random_.below(9); count > 0; --count) {
      if (random_.uniform() < 0.3) spoil();
      else order();
    }
    talk_.faults() = {};
    pass(3);
    judge();
  }

 private:
  double between(double low, double high) { return random_.uniform(low, high); }

  void pass(double seconds) {
    for (const double end = talk_.now_s + seconds; talk_.now_s < end;) {
      // Protocols without a checksum cannot say that a number lost a digit: while a job runs nothing is lost on its
      // way.
      talk_.faults().lose_to_machine = running() ? 0 : lose_to_machine_;
      talk_.pass(0.01);
      watch_bounds();
    }
  }
  template <class Reached>
  bool pass_until(Reached&& reached, double timeout_s) {
    for (const double end = talk_.now_s + timeout_s; talk_.now_s < end && !reached();) pass(0.05);
    return reached();
  }
  bool running() const { return (starts_ || box_) && talk_.ended().empty(); }

  /// Between its start and its end a job stays where it said it would go, but for the way there.
  void watch_bounds() {
    if (!box_) return;
    if (!alone_ && !talk_.ended().empty()) return box_.reset();
    const Point at = talk_.machine.position_mm();
    for (std::size_t k = 0; k < 2; ++k)
      if (at[k] < box_->low_mm[k] - tolerance_mm || at[k] > box_->high_mm[k] + tolerance_mm) {
        ++totals_.left_bounds;
        return box_.reset();
      }
  }

  bool tell(Json command) {
    ++totals_.orders;
    if (random_.uniform() < 0.95) command["confirmed"] = true;
    const bool taken = talk_.refusal(command).empty();
    totals_.refused += taken ? 0 : 1;
    return taken;
  }

  void make_ready() {
    talk_.faults() = {};
    lose_to_machine_ = 0;
    pass_until([&] { return talk_.state()["connection"] == "ready"; }, 12);
    if (talk_.phase() == "paused" || talk_.phase() == "sleep" || talk_.state()["connection"] != "ready" ||
        talk_.state()["alarm"].is_object())
      talk_.refusal({{"do", "stop"}});
    pass_until([&] { return talk_.phase() == "idle" || talk_.phase() == "alarm"; }, 8);
    if (talk_.can("home")) {
      talk_.refusal({{"do", "home"}, {"confirmed", true}});
      pass_until([&] { return talk_.state()["position_known"] == true && talk_.phase() == "idle"; }, 6);
    } else {
      talk_.refusal({{"do", "unlock"}});
      pass(0.5);
    }
    const Json machine = talk_.state()["machine_mm"];
    if (machine.is_array() && random_.uniform() < 0.9) {
      // Away from the corner, to where a job has room.
      const double to = machine[0].get<double>() < -200 || std::abs(machine[0].get<double>()) < 1e-6 ? 60 : -100;
      for (const char* axis : {"x_mm", "y_mm"})
        talk_.refusal({{"do", "jog"}, {axis, to + between(-20, 20)}, {"speed_mm_per_s", 150}});
      pass(0.3);
      pass_until([&] { return talk_.phase() == "idle"; }, 8);
    }
    talk_.refusal({{"do", "set_origin"}, {"axes", "xy"}});
    pass(0.3);
  }

  void order() {
    const double x = between(-20, 60), y = between(-20, 60), speed = between(5, 150);
    switch (random_.below(13)) {
      case 0: tell({{"do", "home"}}); break;
      case 1: tell({{"do", "jog"}, {"x_mm", x}, {"y_mm", y}, {"speed_mm_per_s", speed}}); break;
      case 2: tell({{"do", "go_to"}, {"x_mm", x}, {"y_mm", y}, {"speed_mm_per_s", speed}}); break;
      case 3:
        tell({{"do", "frame"}, {"bounds_mm", {0, 0, std::abs(x) + 1, std::abs(y) + 1}}, {"speed_mm_per_s", speed}});
        break;
      case 4: focus(); break;
      case 5: tell({{"do", "set_origin"}, {"axes", "xy"}}); break;
      case 6: by_hand(); break;
      case 7:
        tell({{"do", "override"}, {"feed_percent", between(20, 200)}, {"power_percent", between(20, 200)}});
        break;
      case 8: tell({{"do", "jog_cancel"}}), tell({{"do", "focus_off"}}); break;
      default: job();
    }
    pass(random_.uniform() < 0.5 ? between(0, 0.3) : between(0, 4));
  }

  void by_hand() {
    static const char* lines[] = {"M3S300", "M4S500", "M5",    "$G", "G0X5Y5", "G91", "G20",
                                  "G55",    "G92X0",  "G92.1", "Q1", "G1F900", "S900"};
    tell({{"do", "send"}, {"line", lines[random_.below(std::size(lines))]}});
  }

  void focus() {
    pass(0.5);
    pass_until([&] { return !talk_.machine.has_work(); }, 2);
    pass(0.5);  // a jog that waited for a pulse of light is done first, and the light shines where it ends
    if (talk_.machine.state() != "Idle" || !tell({{"do", "focus"}, {"power_percent", 2}})) return;
    spots_.push_back(talk_.machine.position_mm());
    pass(between(0.1, 3));
    if (random_.uniform() < 0.15) kill();
  }

  void job() {
    const Job job = random_job(random_);
    if (!talk_.refusal({{"do", "override"}, {"feed_percent", 100}, {"power_percent", 100}}).empty()) pass(0.3);
    try {
      talk_.load(job.text);
    } catch (const Error&) {
      return;  // G64, cut short in the middle of a word, or the one before still runs
    }
    if (!tell({{"do", "start"}})) {
      tell({{"do", "go_to"}, {"x_mm", 0}, {"y_mm", 0}, {"speed_mm_per_s", 150}});
      pass(0.3);
      pass_until([&] { return talk_.phase() == "idle" && talk_.can("start"); }, 6);
      pass(0.6);
      if (!tell({{"do", "start"}})) return make_ready();
    }
    ++totals_.jobs;
    // What was ordered before the job, as an origin, is done before its first line.
    const std::size_t lines_before = talk_.machine.lines().size();
    const auto begun = [&] {
      const auto& lines = talk_.machine.lines();
      return std::find(lines.begin() + static_cast<std::ptrdiff_t>(lines_before), lines.end(), "G0S0") != lines.end();
    };
    starts_ = true;
    for (int ms = 0; ms < 3000 && !begun() && talk_.ended().empty(); ++ms) pass(1e-3);
    starts_ = false;
    const Point origin = job_origin();
    const auto placed = [&](Point p) {
      for (std::size_t k = 0; k < 3; ++k) p[k] += origin[k];
      return p;
    };
    for (const Stroke& stroke : job.strokes) strokes_.push_back({placed(stroke.from), placed(stroke.to)});
    box_ = GcodeBounds{};
    box_->add(talk_.machine.position_mm());
    for (const Point& place : job.places) box_->add(placed(place));
    while (talk_.ended().empty()) {
      pass(between(0, 3));
      const double what = random_.uniform();
      if (what < 0.02) return;  // goes on while other orders come
      if (what < 0.06) tell({{"do", "pause"}}), pass(between(0, 2));
      if (talk_.phase() == "paused") tell({{"do", "resume"}});
      if (what > 0.985) tell({{"do", "stop"}}), pass(1);
      if (what > 0.94) return spoil();
    }
    totals_.done += talk_.ended() == "done" ? 1 : 0;
  }

  /// Where the job's origin is once its first line, which selects G54, is done.
  Point job_origin() const { return talk_.machine.origin_mm(54); }

  void spoil() {
    ++totals_.faults;
    const bool job_runs = running();
    switch (random_.below(7)) {
      case 0:
        if (job_runs && random_.uniform() < 0.5) return;
        talk_.faults().lose_to_host = 0.003;
        lose_to_machine_ = 0.003;
        return;
      case 1:
        // Behind a refused line of a job GRBL acts on the next one until it is stopped (docs/reliability.md), also
        // where the program that sent it is gone.
        if (!job_runs && !talk_.machine.has_work()) talk_.machine.refuse_next(1 + static_cast<int>(random_.below(38)));
        return;
      case 2: talk_.machine.trip_limit(); break;
      case 3: talk_.machine.brown_out(talk_.now_s); break;
      case 4:
        talk_.faults().lose_to_host = 1;
        pass(between(1, 6));
        talk_.faults().lose_to_host = 0;
        tell({{"do", "stop"}});
        break;
      case 5:
        talk_.pull_cable();
        leave_alone(between(0, 5));
        talk_.plug_in();
        break;
      default: kill();
    }
    box_.reset();
    pass(between(0, 2));
    if (random_.uniform() < 0.8) make_ready();
  }

  double light_s() const {
    double sum = 0;
    for (const VirtualGrbl::Burn& burn : talk_.machine.burns()) sum += burn.power <= focus_power ? burn.seconds : 0;
    return sum;
  }

  void kill() {
    ++totals_.kills;
    const double before_s = light_s();
    talk_.kill_host(random_.uniform() < 0.7);
    leave_alone(alone_s);
    totals_.longest_focus_after_kill_s = std::max(totals_.longest_focus_after_kill_s, light_s() - before_s);
    CHECK_FALSE(talk_.machine.beam());
    talk_.plug_in();
  }

  void leave_alone(double seconds) {
    alone_ = true;
    for (const double end = talk_.now_s + seconds; talk_.now_s < end;) talk_.leave_alone(0.05), watch_bounds();
    alone_ = false;
  }

  void judge() {
    for (const VirtualGrbl::Burn& burn : talk_.machine.burns()) {
      double far_mm = 1e9;
      for (const Stroke& stroke : strokes_)
        far_mm = std::min(far_mm, std::max(distance_mm(burn.from_mm, stroke), distance_mm(burn.to_mm, stroke)));
      const bool rests = burn.from_mm == burn.to_mm;
      const bool light =
          rests && burn.power <= focus_power && std::any_of(spots_.begin(), spots_.end(), [&](const Point& spot) {
            return std::hypot(burn.to_mm[0] - spot[0], burn.to_mm[1] - spot[1]) < tolerance_mm;
          });
      if (light) {
        totals_.focus_s += burn.seconds;
      } else if (far_mm <= tolerance_mm && !rests && !burn.jog) {
        totals_.strokes_s += burn.seconds;
        totals_.farthest_mm = std::max(totals_.farthest_mm, far_mm);
      } else {
        totals_.elsewhere_s += burn.seconds;
        FAIL_CHECK("The beam was on for " << burn.seconds << " s with S" << burn.power << (rests ? " at rest" : "")
                                          << (burn.jog ? " in a jog" : "") << " at (" << burn.from_mm[0] << ", "
                                          << burn.from_mm[1] << ") to (" << burn.to_mm[0] << ", " << burn.to_mm[1]
                                          << "), " << far_mm << " mm from a stroke");
      }
    }
  }

  Random random_;
  Totals& totals_;
  GrblTalk talk_;
  std::vector<Stroke> strokes_;
  std::vector<Point> spots_;
  std::optional<GcodeBounds> box_;
  double lose_to_machine_ = 0;
  bool alone_ = false, starts_ = false;  // starts_: a job, whose first line is still to come
};

}  // namespace formwright::reliability_test
