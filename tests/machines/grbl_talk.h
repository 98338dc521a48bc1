// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A driver and the virtual machine on a serial line that takes its time and may spoil what passes.
#include <catch2/catch_test_macros.hpp>

#include <cstdint>
#include <cstdlib>
#include <deque>
#include <functional>
#include <string>

#include "base/error.h"
#include "base/random.h"
#include "machines/grbl/grbl_driver.h"
#include "machines/virtual_grbl/virtual_grbl.h"

namespace formwright {

inline const Json start_job = {{"do", "start"}, {"confirmed", true}}, stop_job = {{"do", "stop"}};

/// FORMWRIGHT_SEED asks for other random programs.
inline std::uint64_t random_seed() {
  const char* given = std::getenv("FORMWRIGHT_SEED");
  return given ? std::strtoull(given, nullptr, 10) : 20261122;
}

struct LineFaults {
  double lose_to_machine = 0, lose_to_host = 0;  // probability of a byte
  double burst_s = 0;                            // the host hears in bursts, as through a USB adapter
};

class GrblTalk {
 public:
  explicit GrblTalk(const VirtualGrblOptions& machine_options = {}, const LineFaults& faults = {},
                    std::uint64_t seed = 1)
      : machine(machine_options),
        driver_options_{.bed_x_mm = machine_options.travel_x_mm, .bed_y_mm = machine_options.travel_y_mm},
        driver(driver_options_),
        faults_(faults),
        random_(seed) {
    driver.opened(now_s);
    machine.open(now_s);
  }

  /// Lets time pass in steps of a millisecond: bytes travel at 11520 a second, the driver ticks every 20 ms.
  void pass(double seconds) {
    for (const double end = now_s + seconds; now_s < end;) {
      now_s += 1e-3;
      for (const Bytes& packet : driver.take_output()) {
        const std::string_view text = as_text(packet);
        // Real-time commands overtake in the driver already; the wire keeps its order.
        to_machine_.append(text);
      }
      budget_ = std::min(budget_ + 11.52, 64.0);
      std::size_t count = 0;
      std::string arrives;
      for (; count < to_machine_.size() && budget_ >= 1; ++count, budget_ -= 1)
        if (random_.uniform() >= faults_.lose_to_machine) arrives += to_machine_[count];
      to_machine_.erase(0, count);
      bytes_sent += static_cast<long>(count);
      machine.receive(arrives, now_s);
      machine.advance(now_s);
      for (const char c : machine.take_output())
        if (random_.uniform() >= faults_.lose_to_host) to_host_ += c;
      if (now_s - heard_s_ >= faults_.burst_s && !to_host_.empty()) {
        driver.received(as_bytes(to_host_), now_s);
        to_host_.clear();
        heard_s_ = now_s;
      }
      if (++steps_ % 20 == 0) driver.tick(now_s);
      for (const Json& event : driver.take_events()) events.push_back(event);
    }
  }
  bool pass_until(const std::function<bool()>& reached, double timeout_s) {
    for (const double end = now_s + timeout_s; now_s < end && !reached();) pass(0.01);
    return reached();
  }

  Json state() const { return driver.state(now_s); }
  std::string phase() const { return state()["phase"]; }
  std::string ended() const {
    return state()["job"].is_null() || state()["job"]["ended"].is_null() ? ""
                                                                         : state()["job"]["ended"].get<std::string>();
  }
  bool can(const std::string& what) const {
    const Json names = state()["can"];
    for (const Json& name : names)
      if (name == what) return true;
    return false;
  }
  void tell(const Json& command) { driver.command(command, now_s); }
  /// What the command is refused with, "" where it is not.
  std::string refusal(const Json& command) {
    try {
      tell(command);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  void load(const std::string& job) { driver.load("test", as_bytes(job)); }

  /// What was on its way is lost; the machine goes on with what it has.
  void pull_cable() {
    driver.closed(now_s);
    driver.take_output();
    to_machine_.clear();
    to_host_.clear();
  }
  /// The program that held the port is gone without a word. What the computer had taken in may still go out.
  void kill_host(bool output_goes_on) {
    driver.take_output();
    driver = GrblDriver(driver_options_);
    if (!output_goes_on) to_machine_.clear();
    to_host_.clear();
  }
  /// The machine on its own.
  void leave_alone(double seconds) {
    for (const double end = now_s + seconds; now_s < end;) {
      now_s += 1e-3;
      const std::size_t count = std::min<std::size_t>(to_machine_.size(), 11);
      machine.receive(to_machine_.substr(0, count), now_s);
      to_machine_.erase(0, count);
      machine.advance(now_s);
      machine.take_output();
    }
  }
  LineFaults& faults() { return faults_; }
  void plug_in() {
    machine.take_output();
    driver.opened(now_s);
    machine.open(now_s);
  }
  void connect() {
    {
      const bool reached = pass_until([&] { return state()["connection"] == "ready"; }, 10);
      INFO(state().dump());
      REQUIRE(reached);
    }
  }
  void connect_and_home() {
    connect();
    {
      const bool reached = pass_until([&] { return can("home"); }, 5);
      INFO(state().dump());
      REQUIRE(reached);
    }
    tell({{"do", "home"}, {"confirmed", true}});
    {
      const bool reached = pass_until([&] { return state()["position_known"] == true && phase() == "idle"; }, 20);
      INFO(state().dump());
      REQUIRE(reached);
    }
    tell({{"do", "jog"}, {"x_mm", -300}, {"y_mm", -300}, {"speed_mm_per_s", 150}});
    pass(0.5);
    REQUIRE(pass_until([&] { return phase() == "idle"; }, 20));
    tell({{"do", "set_origin"}, {"axes", "xy"}});
    pass(0.5);
    {
      const bool reached =
          pass_until([&] { return phase() == "idle" && std::abs(state()["work_mm"][0].get<double>()) < 1e-9; }, 5);
      INFO(state().dump());
      REQUIRE(reached);
    }
  }

  VirtualGrbl machine;

 private:
  DriverOptions driver_options_;

 public:
  GrblDriver driver;
  double now_s = 0;
  std::vector<Json> events;
  long bytes_sent = 0;

 private:
  LineFaults faults_;
  Random random_;
  std::string to_machine_, to_host_;
  double budget_ = 0, heard_s_ = 0;
  long steps_ = 0;
};

}  // namespace formwright
