// SPDX-License-Identifier: GPL-3.0-or-later
// What a person may ask of a Marlin machine, and when.
#include <algorithm>
#include <cmath>
#include <limits>

#include "machines/marlin_driver.h"

namespace formwright {
namespace {

using machines_detail::decimal;
using machines_detail::number_of;
using machines_detail::refuse;
using machines_detail::require_confirmation;

constexpr double absent = std::numeric_limits<double>::quiet_NaN(), farthest_mm = 10000;
constexpr std::size_t longest_by_hand = 80;
constexpr double jog_starts_s = 0.3;  // until the line is there and the head is as fast as it should be

}  // namespace

MachinePhase MarlinDriver::phase() const {
  const bool ready = connection_ == MachineConnection::ready;
  if (ready && halted_) return MachinePhase::alarm;
  if (stopped_s_ >= 0) return MachinePhase::stopping;
  if (!ready) return MachinePhase::unknown;
  if (settling_ == Settles::homing) return MachinePhase::homing;
  if (settling_ == Settles::moving) return MachinePhase::jogging;
  if (job_active()) return paused_ ? MachinePhase::paused : MachinePhase::running;
  return jogging_until_s_ ? MachinePhase::jogging : MachinePhase::idle;
}

bool MarlinDriver::is_free() const {
  const MachinePhase now = phase();
  return now == MachinePhase::idle || (now == MachinePhase::jogging && settling_ == Settles::nothing);
}

std::vector<std::string> MarlinDriver::possible_commands() const {
  std::vector<std::string> can;
  if (connection_ == MachineConnection::closed) return can;
  can.push_back("stop");
  const MachinePhase now = phase();
  const auto add = [&](std::initializer_list<const char*> names) { can.insert(can.end(), names.begin(), names.end()); };
  if (now == MachinePhase::running) add({"pause", "override"});
  if (now == MachinePhase::paused) add({"resume", "override"});
  if (!is_free()) return can;
  add({"home", "jog", "set_origin", "send", "override"});
  if (position_known_) add({"go_to", "frame"});
  if (options_.tool == MachineTool::laser) add({focus_until_s_ ? "focus_off" : "focus"});
  // A printer's own G-code homes it.
  if (now == MachinePhase::idle && program_.line_count() > 0 &&
      (position_known_ || options_.tool == MachineTool::printer))
    add({"start"});
  return can;
}

void MarlinDriver::move(const std::string& mode, const std::string& words, double speed_mm_per_s) {
  queue(mode);
  queue("G0" + words + " F" + decimal(60 * speed_mm_per_s));
  if (mode == "G91") queue("G90");
}

void MarlinDriver::command(const Json& command, double now_s) {
  const std::string what = machines_detail::command_name(command, connection_);
  if (what == "stop") return stop("stopped", now_s);
  const std::vector<std::string> can = possible_commands();
  if (std::find(can.begin(), can.end(), what) == can.end()) {
    if (what == "unlock" || halted_) refuse(what, "The machine has halted: switch it off and on again.");
    if ((what == "start" || what == "frame" || what == "go_to") && is_free() && !position_known_)
      refuse(what, "Where the head stands is unknown: home the machine first.");
    if (what == "start" && program_.line_count() == 0) refuse(what, "No job is loaded: choose one first.");
    machines_detail::refuse_in_phase(what, phase());
  }
  const auto speed = [&](double fallback) { return number_of(command, "speed_mm_per_s", 0.01, 2000, fallback); };
  if (what == "home") {
    require_confirmation(command, "The head moves to its switches");
    queue("G28");
    settle(Settles::homing);
  } else if (what == "jog") jog(command, now_s);
  else if (what == "set_origin") set_origin(command);
  else if (what == "go_to") {
    GcodeBounds bounds;
    bounds.add({number_of(command, "x_mm", -farthest_mm, farthest_mm, absent),
                number_of(command, "y_mm", -farthest_mm, farthest_mm, absent), 0});
    check_reach(bounds);
    move("G90", " X" + decimal(bounds.low_mm[0]) + " Y" + decimal(bounds.low_mm[1]), speed(50));
    settle(Settles::moving);
  } else if (what == "frame") {
    require_confirmation(command, "The head moves once around the job, laser off");
    const std::array<double, 4> b = machines_detail::bounds_of(command);
    GcodeBounds bounds;
    bounds.add({b[0], b[1], 0});
    bounds.add({b[2], b[3], 0});
    check_reach(bounds);
    for (const auto& [x, y] : machines_detail::way_around(b))
      move("G90", " X" + decimal(x) + " Y" + decimal(y), speed(50));
    settle(Settles::moving);
  } else if (what == "focus") {
    const double power = number_of(command, "power_percent", 0, options_.focus_power_percent, absent);
    require_confirmation(command, "The laser shines at " + decimal(power) + " % without moving: eyes protected");
    queue("M3 S" + decimal(2.55 * power));
    focus_until_s_ = now_s + options_.focus_seconds;
  } else if (what == "focus_off") focus_off(now_s);
  else if (what == "start") start(command, now_s);
  else if (what == "pause") {
    paused_ = true;
    // What is planned is still done; a laser must not stay on where that ends.
    if (options_.tool == MachineTool::laser) queue("M5");
  } else if (what == "resume") {
    require_confirmation(command, "The machine goes on, with its laser or heaters on");
    paused_ = false;
    const GcodeState s = program_.state_before(next_line_);
    if (options_.tool == MachineTool::laser && s.spindle != 5)
      queue("M" + std::to_string(s.spindle) + " S" + decimal(s.power));
  } else if (what == "send") {
    const std::string text = machines_detail::line_of(command, longest_by_hand);
    const LineEffect effect = effect_of(text);
    if (effect.moves || effect.fires)
      require_confirmation(command, "The line \"" + text + "\" may move the machine, heat it or turn its laser on");
    queue(text);
    ask_soon();  // it may move the head
    if (text.starts_with("G28")) settle(Settles::homing);
  } else if (what == "override") {
    if (command.contains("feed_percent")) queue("M220 S" + decimal(number_of(command, "feed_percent", 10, 200, 100)));
  }
  pump(now_s);
}

void MarlinDriver::jog(const Json& command, double now_s) {
  std::string words;
  double squared_mm = 0;
  for (const auto& [name, letter] : {std::pair{"x_mm", " X"}, std::pair{"y_mm", " Y"}, std::pair{"z_mm", " Z"}})
    if (const double mm = number_of(command, name, -farthest_mm, farthest_mm, 0); mm != 0) {
      words += letter + decimal(mm);
      squared_mm += mm * mm;
    }
  if (words.empty()) refuse("x_mm", "A jog needs x_mm, y_mm or z_mm.");
  const double speed_mm_per_s = number_of(command, "speed_mm_per_s", 0.01, 2000, absent);
  if (by_hand_.size() >= 12) return;  // a key held down repeats faster than the head moves
  move("G91", words, speed_mm_per_s);
  jogging_until_s_ =
      std::max(jogging_until_s_.value_or(0), now_s + jog_starts_s) + std::sqrt(squared_mm) / speed_mm_per_s;
}

void MarlinDriver::set_origin(const Json& command) {
  const std::string words = machines_detail::zero_words(command, " ");
  queue("G92" + words);
  position_known_ = true;
  // Known at once; the machine tells of it only when it is asked again.
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (position_mm_ && words.find("XYZ"[axis]) != std::string::npos) (*position_mm_)[axis] = 0;
  ask_soon();
}

void MarlinDriver::check_reach(const GcodeBounds& bounds) const {
  const double bed[] = {options_.bed_x_mm, options_.bed_y_mm};
  for (std::size_t axis = 0; axis < 2; ++axis)
    if (bounds.named[axis] && bounds.high_mm[axis] - bounds.low_mm[axis] > bed[axis] + 1e-3)
      refuse("job", std::string("The job is ") + decimal(bounds.high_mm[axis] - bounds.low_mm[axis]) + " mm long in " +
                        "xy"[axis] + ", the machine reaches " + decimal(bed[axis]) +
                        " mm: make it smaller or turn it.");
}

void MarlinDriver::start(const Json& command, double now_s) {
  require_confirmation(command, options_.tool == MachineTool::printer
                                    ? "The printer heats up and moves"
                                    : "The machine moves and its laser or spindle turns on");
  if (number_of(command, "from_line", 1, 1e9, 1) > 1)
    refuse("from_line", "Going on in the middle of a job is possible with GRBL machines only: start it anew.");
  if (options_.tool != MachineTool::printer) {  // its jobs home it themselves
    require_head_at_origin(program_, 0, position_mm_);
    check_reach(program_.bounds());
  }
  refused_.reset();
  if (focus_until_s_) focus_off(now_s);  // before the job, whose own first move may come late
  paused_ = false;
  job_ = MachineJob{program_name_, program_.line_count(), 0, 0, 0, now_s, 0, ""};
  next_line_ = 0;
}

Json MarlinDriver::state(double now_s) const {
  Json state = common_state("marlin", connection_, phase(), {position_known_, position_known_, position_known_}, now_s);
  state["firmware"] = firmware_;
  if (position_mm_) state["machine_mm"] = state["work_mm"] = *position_mm_;
  state["laser_on"] = focus_until_s_.has_value();
  state["temperatures"] = temperatures_;
  if (halted_)
    state["alarm"] = {{"code", 0},
                      {"text", "The machine has halted: " + halt_text_},
                      {"mend", "Find the cause, then switch it off and on again."}};
  if (refused_)
    state["error"] = {{"code", 0},
                      {"text", "The machine does not know a command of the job."},
                      {"line", *refused_},
                      {"line_number", job_ ? job_->line_now : 0}};
  if (job_active() && options_.tool == MachineTool::laser) state["laser_on"] = nullptr;  // Marlin does not tell
  state["can"] = possible_commands();
  return state;
}

}  // namespace formwright
