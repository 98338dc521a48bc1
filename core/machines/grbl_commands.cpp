// SPDX-License-Identifier: GPL-3.0-or-later
// What a person may ask of a GRBL machine, and when.
#include <algorithm>
#include <cmath>
#include <limits>

#include "machines/grbl_driver.h"

namespace formwright {
namespace {

using machines_detail::decimal;
using machines_detail::number_of;
using machines_detail::refuse;
using machines_detail::require_confirmation;

constexpr double absent = std::numeric_limits<double>::quiet_NaN(), farthest_mm = 10000;
constexpr char jog_cancel_command = static_cast<char>(0x85);
constexpr int planner_blocks = 16;  // lines that may be answered and not done yet

}  // namespace

std::vector<std::string> GrblDriver::possible_commands() const {
  std::vector<std::string> can;
  if (connection_ == MachineConnection::closed) return can;
  can.push_back("stop");
  if (connection_ != MachineConnection::ready || stopping_ != Stopping::no) return can;
  const auto add = [&](std::initializer_list<const char*> names) { can.insert(can.end(), names.begin(), names.end()); };
  const bool busy = job_active();
  if (phase_ == MachinePhase::alarm) {
    if (homes()) add({"home"});
    add({"unlock", "send"});
  }
  if (busy && (phase_ == MachinePhase::running || phase_ == MachinePhase::idle) && !pause_asked_)
    add({"pause", "override"});
  if (phase_ == MachinePhase::jogging) add({"jog_cancel", "jog", "pause"});
  if (phase_ == MachinePhase::paused || phase_ == MachinePhase::door) add({"resume", "override"});
  if (phase_ != MachinePhase::idle || busy) return can;
  if (homes()) add({"home"});
  add({"jog", "jog_cancel", "set_origin", "send", "override"});
  if (position_known_) add({"go_to", "frame"});
  if (options_.tool == MachineTool::laser) add({focus_until_s_ ? "focus_off" : "focus"});
  if (position_known_ && program_.line_count() > 0 && !waits("$J")) add({"start"});
  return can;
}

void GrblDriver::command(const Json& command, double now_s) {
  const std::string what = machines_detail::command_name(command, connection_);
  if (what == "stop") return stop("stopped", now_s);
  const std::vector<std::string> can = possible_commands();
  if (std::find(can.begin(), can.end(), what) == can.end()) {
    if (connection_ != MachineConnection::ready)
      refuse(what, "The machine does not answer: check that it is on and connected.");
    if (what == "home" && !homes())
      refuse(what, "Homing is not switched on in this machine ($22): jog to the origin and set it there.");
    if ((what == "start" || what == "frame" || what == "go_to") && phase_ == MachinePhase::idle && !job_active() &&
        !position_known_)
      refuse(what, homes()
                       ? "Where the head stands is unknown: home the machine first."
                       : "Where the head stands is unknown: jog to the material's corner and set the origin first.");
    if (what == "start" && program_.line_count() == 0) refuse(what, "No job is loaded: choose one first.");
    if (what == "start" && waits("$J")) refuse(what, "The head still moves: wait until it rests.");
    machines_detail::refuse_in_phase(what, phase_);
  }
  if (what == "home") {
    require_confirmation(command, "The head moves to its switches");
    refused_.reset();
    if (limits_hit_ || !stream_.empty()) after_banner_ = {"$H"}, reset(now_s);
    else queue("$H");
  } else if (what == "unlock") {
    lose_position();
    if (limits_hit_ || !stream_.empty()) after_banner_ = {"$X"}, reset(now_s);
    else queue("$X");
  } else if (what == "jog") jog(command);
  else if (what == "jog_cancel") {
    std::erase_if(by_hand_, [](const std::string& line) { return line.starts_with("$J"); });
    send_now(jog_cancel_command);
  } else if (what == "set_origin") set_origin(command);
  else if (what == "go_to") go_to(command);
  else if (what == "frame") frame(command);
  else if (what == "focus") focus(command, now_s);
  else if (what == "focus_off") focus_off();
  else if (what == "start") start(command, now_s);
  else if (what == "pause") {
    pause_asked_ = true;
    send_now('!');
  } else if (what == "resume") {
    require_confirmation(command, "The machine goes on, with its laser or spindle on");
    pause_asked_ = false;
    send_now('~');
    phase_ = MachinePhase::running;  // until the next report: lines may follow at once
  } else if (what == "send") send_by_hand(command);
  else override_speeds(command);
  pump(now_s);
}

double GrblDriver::speed_mm_per_min(const Json& command, double fallback_mm_per_s) const {
  return 60 * number_of(command, "speed_mm_per_s", 0.01, 2000, fallback_mm_per_s);
}

void GrblDriver::jog(const Json& command) {
  std::string words;
  for (const auto& [name, letter] : {std::pair{"x_mm", 'X'}, std::pair{"y_mm", 'Y'}, std::pair{"z_mm", 'Z'}})
    if (const double mm = number_of(command, name, -farthest_mm, farthest_mm, 0); mm != 0)
      words += letter + decimal(mm);
  if (words.empty()) refuse("x_mm", "A jog needs x_mm, y_mm or z_mm.");
  if (by_hand_.size() > 8) return;  // a key held down repeats faster than the head moves
  queue("$J=G91G21" + words + "F" + decimal(speed_mm_per_min(command, absent)));
}

void GrblDriver::go_to(const Json& command) {
  GcodeBounds bounds;
  bounds.add({number_of(command, "x_mm", -farthest_mm, farthest_mm, absent),
              number_of(command, "y_mm", -farthest_mm, farthest_mm, absent), 0});
  check_reach(bounds);
  queue("$J=G90G21X" + decimal(bounds.low_mm[0]) + "Y" + decimal(bounds.low_mm[1]) + "F" +
        decimal(speed_mm_per_min(command, 50)));
}

void GrblDriver::frame(const Json& command) {
  require_confirmation(command, "The head moves once around the job, laser off");
  const std::array<double, 4> b = machines_detail::bounds_of(command);
  GcodeBounds bounds;
  bounds.add({b[0], b[1], 0});
  bounds.add({b[2], b[3], 0});
  check_reach(bounds);
  const std::string speed = "F" + decimal(speed_mm_per_min(command, 50));
  for (const auto& [x, y] : machines_detail::way_around(b)) queue("$J=G90G21X" + decimal(x) + "Y" + decimal(y) + speed);
}

void GrblDriver::set_origin(const Json& command) {
  if (command.value("at", Json("head")) == "corner") {
    if (!homes() || !position_known_)
      refuse("at", "Where the bed's corner is only a homed machine knows: home it first.");
    queue("G10L2P0X" + decimal(reach_low(0)) + "Y" + decimal(reach_low(1)));
    return expect_origin({reach_low(0), reach_low(1), std::nullopt});
  }
  const std::string words = machines_detail::zero_words(command, "");
  queue("G10L20P0" + words);
  std::array<std::optional<double>, 3> head;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (machine_mm_ && words.find("XYZ"[axis]) != std::string::npos) head[axis] = (*machine_mm_)[axis];
  expect_origin(head);
}

void GrblDriver::expect_origin(const std::array<std::optional<double>, 3>& machine_mm) {
  if (!offset_mm_ || !machine_mm_) return;
  work_mm_ = machine_mm_;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    (*offset_mm_)[axis] = machine_mm[axis].value_or((*offset_mm_)[axis]);
    (*work_mm_)[axis] -= (*offset_mm_)[axis];
  }
}

bool GrblDriver::origin_moves() const { return waits("G10"); }

bool GrblDriver::waits(std::string_view beginning) const {
  return stream_.waits_for(beginning) || std::any_of(by_hand_.begin(), by_hand_.end(), [&](const std::string& line) {
           return line.starts_with(beginning);
         });
}

void GrblDriver::focus(const Json& command, double now_s) {
  const double power = number_of(command, "power_percent", 0, options_.focus_power_percent, absent);
  require_confirmation(command, "The laser shines at " + decimal(power) + " % without moving: eyes protected");
  // In laser mode the beam is on at rest only with M3 and a cutting motion.
  queue("G1F1000");
  queue("M3S" + decimal(0.01 * power * setting(30, 1000)));
  focus_until_s_ = now_s + options_.focus_seconds;
}

void GrblDriver::focus_off() {
  focus_until_s_.reset();
  queue("M5S0");
  queue("G0");
}

void GrblDriver::send_by_hand(const Json& command) {
  std::string line = machines_detail::line_of(command, 78);
  std::erase_if(line, [](char c) { return c == ' ' || c == '\t'; });
  std::transform(line.begin(), line.end(), line.begin(),
                 [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
  if (line == "?") return send_now('?');
  if (line.find_first_of("!~?") != std::string::npos)
    refuse("line", "Use the buttons to hold and to go on: they are watched over.");
  const LineEffect effect = effect_of(line);
  if (effect.moves || effect.fires)
    require_confirmation(command, effect.fires ? "The line \"" + line + "\" may turn the laser or spindle on"
                                               : "The line \"" + line + "\" moves the machine");
  if (line.starts_with("$RST") ||
      (line.starts_with("$") && line.find('=') != std::string::npos && !line.starts_with("$J"))) {
    settings_.clear();  // asked for again, so that what is known stays true
    queue(line);
    queue("$$");
    return;
  }
  if (line.starts_with("$H") && !homes()) refuse("line", "Homing is not switched on in this machine ($22).");
  queue(line);
}

void GrblDriver::override_speeds(const Json& command) {
  const auto steps = [&](double target, int now, char reset, char up10, char down10, char up1, char down1) {
    const int wanted = static_cast<int>(std::lround(target));
    if (wanted == 100) return send_now(reset);
    for (; wanted - now >= 10; now += 10) send_now(up10);
    for (; now - wanted >= 10; now -= 10) send_now(down10);
    for (; wanted > now; ++now) send_now(up1);
    for (; now > wanted; --now) send_now(down1);
  };
  if (command.contains("feed_percent"))
    steps(number_of(command, "feed_percent", 10, 200, 100), overrides_[0], char(0x90), char(0x91), char(0x92),
          char(0x93), char(0x94));
  if (command.contains("power_percent"))
    steps(number_of(command, "power_percent", 10, 200, 100), overrides_[2], char(0x99), char(0x9a), char(0x9b),
          char(0x9c), char(0x9d));
}

double GrblDriver::reach_low(int axis) const {
  // Machine coordinates run from the switches to 0 or, where homing sets the origin, from 0 away from them.
  const bool origin_at_switch = option_letters_.find('Z') != std::string::npos;
  const bool homes_low = (static_cast<int>(setting(23, 0)) >> axis) & 1;
  return origin_at_switch && homes_low ? 0 : -setting(130 + axis, axis == 0 ? options_.bed_x_mm : options_.bed_y_mm);
}

void GrblDriver::check_reach(const GcodeBounds& bounds) const {
  static constexpr char names[] = {'x', 'y'};
  const double bed[] = {setting(130, options_.bed_x_mm), setting(131, options_.bed_y_mm)};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    if (!bounds.named[axis]) continue;
    const std::string name(1, names[axis]);
    const double length = bounds.high_mm[axis] - bounds.low_mm[axis];
    if (length > bed[axis] + 1e-3)
      refuse("job", "The job is " + decimal(length) + " mm long in " + name + ", the machine reaches " +
                        decimal(bed[axis]) + " mm: make it smaller or turn it.");
    if (!homes() || !position_known_ || !offset_mm_) continue;
    const double low = reach_low(static_cast<int>(axis)), high = low + bed[axis], offset = (*offset_mm_)[axis];
    if (bounds.low_mm[axis] + offset < low - 1e-3 || bounds.high_mm[axis] + offset > high + 1e-3)
      refuse("job", "The job would leave the bed in " + name + ": from the origin it may go from " +
                        decimal(low - offset) + " to " + decimal(high - offset) + " mm, and goes from " +
                        decimal(bounds.low_mm[axis]) + " to " + decimal(bounds.high_mm[axis]) +
                        " mm. Move the origin or the job.");
  }
}

int GrblDriver::careful_line() const {
  if (!job_) return 1;
  // All before the planner's blocks is done; from there back to where a travel begins, so that a cut starts anew and
  // not in its middle.
  return program_.number(program_.rapid_before(std::max(job_->acknowledged - planner_blocks, 0)));
}

std::vector<std::string> GrblDriver::way_back_to(int index) const {
  const GcodeState s = program_.state_before(index);
  std::vector<std::string> lines = {"G21G90G94G" + std::to_string(s.plane), "G" + std::to_string(s.work_system), "M5"};
  const bool mill = options_.tool == MachineTool::mill;
  if (mill && s.moved[2]) lines.push_back("G0Z" + decimal(program_.bounds().high_mm[2]));
  // On an axis that the job has not named yet the head stays where it is; jobs that count from here begin at 0.
  std::string way;
  const bool any = s.moved[0] || s.moved[1], from_zero = any && program_.from_here();
  if (s.moved[0] || from_zero) way += "X" + decimal(s.position_mm[0]);
  if (s.moved[1] || from_zero) way += "Y" + decimal(s.position_mm[1]);
  if (!way.empty()) lines.push_back("G0" + way);
  if (s.mist) lines.push_back("M7");
  if (s.flood) lines.push_back("M8");
  if (s.spindle != 5) lines.push_back("M" + std::to_string(s.spindle) + "S" + decimal(s.power));
  if (mill && s.spindle != 5) lines.push_back("G4P3");
  const std::string feed = s.feed_mm_per_min > 0 ? "F" + decimal(s.feed_mm_per_min) : "";
  if (mill && s.moved[2]) lines.push_back("G1Z" + decimal(s.position_mm[2]) + (feed.empty() ? "F100" : feed));
  if (s.motion <= 1 && (s.motion == 0 || !feed.empty())) lines.push_back("G" + std::to_string(s.motion) + feed);
  if (s.inches) lines.push_back("G20");
  if (s.relative) lines.push_back("G91");
  return lines;
}

void GrblDriver::start(const Json& command, double now_s) {
  require_confirmation(command,
                       program_.fires() ? "The machine moves and its laser or spindle turns on" : "The machine moves");
  const double mode = setting(32, options_.tool == MachineTool::laser ? 1 : 0);
  if (program_.fires() && options_.tool == MachineTool::laser && mode == 0)
    refuse("start",
           "Laser mode is off in the machine, so the beam would stay on at every corner and travel: send $32=1 first.");
  if (program_.fires() && options_.tool == MachineTool::mill && mode != 0)
    refuse("start", "Laser mode is on in the machine, so the spindle would stop at every travel: send $32=0 first.");
  const int from_line = static_cast<int>(number_of(command, "from_line", 1, 1e9, 1));
  const int index = program_.index_of(from_line);
  if (index >= program_.line_count())
    refuse("from_line", "The job has " + std::to_string(program_.number(program_.line_count() - 1)) +
                            " lines: go on from one of them.");
  require_head_at_origin(program_, index, work_mm_);
  check_reach(program_.bounds());
  const bool z_known = homes() && position_known_ && offset_mm_;
  if (const double travel_mm = setting(132, 0); travel_mm > 0)
    require_z_reach(program_.bounds(), travel_mm,
                    z_known ? std::optional(reach_low(2) - (*offset_mm_)[2]) : std::nullopt);
  if (focus_until_s_) focus_off();  // before the job, whose own first move may come late
  refused_.reset();
  pause_asked_ = false;
  job_ = MachineJob{
      program_name_, program_.line_count(), index, index, index > 0 ? program_.number(index - 1) : 0, now_s, 0, ""};
  next_line_ = index;
  progress_s_ = answered_s_ = now_s;
  idle_since_s_ = -1;
  if (index > 0)
    for (const std::string& line : way_back_to(index)) queue(line);
}

}  // namespace formwright
