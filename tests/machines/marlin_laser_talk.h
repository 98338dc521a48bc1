// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A Marlin driver in talk with a laser that is not there, watched by somebody who knows where it may shine.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "base/error.h"
#include "machines/marlin/marlin_driver.h"
#include "machines/virtual_marlin.h"

namespace formwright {

/// Where a job burns: its cuts in work coordinates, and the mode that it turns the laser on in.
struct LaserJob {
  enum class Mode { dynamic, continuous, standard };
  Mode mode = Mode::dynamic;
  std::string text;
  std::vector<std::array<double, 4>> cuts_mm;
  std::array<double, 4> bounds_mm{};

  bool on_cut(double x, double y) const {
    return std::any_of(cuts_mm.begin(), cuts_mm.end(), [&](const std::array<double, 4>& cut) {
      const double dx = cut[2] - cut[0], dy = cut[3] - cut[1], squared = dx * dx + dy * dy;
      const double t = squared > 0 ? std::clamp(((x - cut[0]) * dx + (y - cut[1]) * dy) / squared, 0.0, 1.0) : 0;
      return std::hypot(x - cut[0] - t * dx, y - cut[1] - t * dy) < 0.02;
    });
  }
};

struct MarlinLaserTalk {
  static constexpr double step_s = 0.002;

  MarlinLaserTalk(const VirtualMarlinOptions& machine_options, std::uint64_t seed, double focus_seconds = 60)
      : machine(machine_options, seed),
        options{.controller = DriverController::marlin,
                .tool = MachineTool::laser,
                .bed_x_mm = machine_options.bed_mm[0],
                .bed_y_mm = machine_options.bed_mm[1],
                .focus_seconds = focus_seconds},
        driver(options) {
    driver.opened(machine.now_s());
  }

  void pass(double seconds) {
    for (const double end = machine.now_s() + seconds; machine.now_s() < end;) step();
  }
  void step() {
    if (host_alive) {
      for (const Bytes& packet : driver.take_output())
        if (cable) machine.receive(as_text(packet));
    }
    machine.advance(step_s);
    const std::string said = machine.take_output();
    if (host_alive && cable) driver.received(as_bytes(said), machine.now_s());
    if (host_alive) driver.tick(machine.now_s());
    watch();
  }
  bool try_tell(const Json& command) {
    try {
      driver.command(command, machine.now_s());
      return true;
    } catch (const Error&) {
      return false;
    }
  }
  /// What is still to be written is cut anywhere, and nothing follows.
  void kill_host(Random& random) {
    std::string last;
    for (const Bytes& packet : driver.take_output()) last += as_text(packet);
    if (!last.empty()) machine.receive(last.substr(0, random.below(last.size() + 1)));
    host_alive = false;
    killed_s = machine.now_s();
  }
  /// Another session takes the port, which some boards restart at.
  void attach(bool restarts) {
    driver.closed(machine.now_s());
    driver = MarlinDriver(options);
    if (restarts) machine.restart();
    driver.opened(machine.now_s());
    host_alive = cable = true;
    killed_s = -1;
    at_focus = by_hand = false;
    homed_before = machine.homed_times;
    left_on = machine.shines();
  }
  Json state() const { return driver.state(machine.now_s()); }
  std::string phase() const { return state()["phase"]; }
  bool can(const std::string& what) const {
    const Json names = state()["can"];
    return std::find(names.begin(), names.end(), what) != names.end();
  }
  bool wait_for(const std::string& wanted, double seconds) {
    for (const double end = machine.now_s() + seconds; machine.now_s() < end; step())
      if (phase() == wanted) return true;
    return false;
  }
  /// The person lets it shine at rest: where it does so first, there it may, until it does so elsewhere by an order.
  void expect_spot(bool focus) {
    spot_is_open = true;
    at_focus = focus, by_hand = !focus;
  }

  VirtualMarlin machine;
  DriverOptions options;
  MarlinDriver driver;
  bool host_alive = true, cable = true;
  double killed_s = -1;
  long homed_before = 0;
  bool left_on = false;  // by the host before
  LaserJob job;
  std::array<double, 3> spot_mm{};
  bool at_focus = false, by_hand = false, spot_is_open = false;

  // What was seen, in seconds.
  double outside_s = 0;               // beside every cut and spot: 0 is promised
  double killed_rest_s = 0;           // at rest behind a dead host, by a job or a line that is not dynamic
  double killed_dynamic_s = 0;        // the same by a dynamic one, or a focus light: 0 is promised
  double rest_s = 0, max_rest_s = 0;  // at rest on a cut while the host lives
  double lit_s = 0, spot_s = 0;
  double outside_bed_mm = 0;
  std::string first_outside;

 private:
  void watch() {
    const auto head = machine.head_mm();
    // Where this driver has homed the machine it can know; jogs are the person's.
    if (machine.homed_times > homed_before)
      for (std::size_t axis = 0; axis < 2; ++axis)
        if (const double over_mm = std::max(-head[axis], head[axis] - bed(axis));
            over_mm > outside_bed_mm && phase() == "running")
          outside_bed_mm = over_mm;
    if (!machine.shines()) {
      rest_s = 0;
      left_on = false;
      return;
    }
    lit_s += step_s;
    const auto zero = machine.work_zero_mm();
    if (spot_is_open && !machine.moves() && (at_focus || by_hand)) spot_mm = head, spot_is_open = false;
    const bool at_spot = std::hypot(head[0] - spot_mm[0], head[1] - spot_mm[1]) < 0.02 && (at_focus || by_hand);
    if (at_spot && !machine.moves()) {
      spot_s += step_s;
      if (by_hand && !host_alive) killed_rest_s += step_s;
      // A focus light ends by itself soon behind a dead host.
      if (at_focus && !host_alive && machine.now_s() - killed_s > 0.5) killed_dynamic_s += step_s;
      return;
    }
    if (left_on && !machine.moves()) {
      killed_rest_s += step_s;
      return;
    }
    if (job.on_cut(head[0] - zero[0], head[1] - zero[1])) {
      rest_s = machine.moves() ? 0 : rest_s + step_s;
      if (host_alive) max_rest_s = std::max(max_rest_s, rest_s);
      else if (!machine.moves()) (job.mode == LaserJob::Mode::dynamic ? killed_dynamic_s : killed_rest_s) += step_s;
      return;
    }
    if (outside_s == 0)
      first_outside = "at " + std::to_string(machine.now_s()) + " s, in the phase " + phase() + ", " +
                      (host_alive ? "" : "the host dead, ") + std::to_string(head[0] - zero[0]) + " " +
                      std::to_string(head[1] - zero[1]);
    outside_s += step_s;
  }
  double bed(std::size_t axis) const { return axis == 0 ? options.bed_x_mm : options.bed_y_mm; }
};

}  // namespace formwright
