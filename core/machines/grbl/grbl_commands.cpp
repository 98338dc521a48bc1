// SPDX-License-Identifier: GPL-3.0-or-later
// What a person may ask of a GRBL machine, and when.
#include <algorithm>
#include <cmath>

#include "machines/grbl/grbl_driver.h"

namespace formwright {
namespace {

using machines_detail::absent_number;
using machines_detail::decimal;
using machines_detail::number_of;
using machines_detail::refuse;
using machines_detail::require_confirmation;

constexpr double max_grbl_distance_mm = 10000;

}  // namespace

std::vector<std::string> GrblDriver::possible_commands() const {
  std::vector<std::string> can;
  if (connection_ == MachineConnection::closed) return can;
  can.push_back("stop");
  if (connection_ != MachineConnection::ready || stopping_ != Stopping::no || pendant_) return can;
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
  add({"jog", "jog_cancel", "set_origin", "send"});
  if (!focus_until_s_ && !pulse_) add({"override"});
  if (place_known()) add({"go_to", "frame"});
  if (is_laser()) add({focus_until_s_ ? "focus_off" : "focus"});
  if (program_.line_count() > 0 && unknown_place().empty() && !waits_for_motion()) add({"start"});
  return can;
}

void GrblDriver::command(const Json& command, double now_s) {
  const std::string what = machines_detail::command_name(command, connection_);
  if (what == "stop") return stop("stopped", now_s);
  const std::vector<std::string> can = possible_commands();
  // The light may have gone out by itself meanwhile.
  if (std::find(can.begin(), can.end(), what) == can.end() && what != "focus_off") refuse_now(what);
  act_on(what, command, now_s);
  pump(now_s);
}

/// Says why it cannot be done now.
void GrblDriver::refuse_now(const std::string& what) const {
  if (connection_ != MachineConnection::ready)
    refuse(what, "The machine does not answer: check that it is on and connected.");
  if (pendant_) refuse(what, "A hand-held control has the machine: give it back there first.");
  if (what == "home" && !homes())
    refuse(what, "Homing is not switched on in this machine ($22): jog to the origin and set it there.");
  if (what == "start" && program_.line_count() == 0) refuse(what, "No job is loaded: choose one first.");
  if (phase_ == MachinePhase::idle && !job_active()) {
    if ((what == "frame" || what == "go_to") && !place_known())
      refuse(what, homes()
                       ? "Where the head stands is unknown: home the machine first."
                       : "Where the head stands is unknown: jog to the material's corner and set the origin first.");
    if (what == "start" && !unknown_place().empty()) refuse(what, unknown_place());
  }
  if (what == "start" && waits_for_motion()) refuse(what, "The head is still moving: wait until it stops.");
  machines_detail::refuse_in_phase(what, phase_);
}

void GrblDriver::act_on(const std::string& what, const Json& command, double now_s) {
  if (what == "home") home(command, now_s);
  else if (what == "unlock") {
    lose_position();
    if (needs_reset_ || !stream_.empty()) after_banner_ = {"$X"}, reset(now_s);
    else queue("$X");
  } else if (what == "jog") jog(command);
  else if (what == "jog_cancel") {
    std::erase_if(by_hand_, [](const std::string& line) { return line.starts_with("$J"); });
    focus_until_s_.reset();
    cancel_jog(now_s);
  } else if (what == "set_origin") set_origin(command);
  else if (what == "go_to") go_to(command);
  else if (what == "frame") frame(command);
  else if (what == "focus") focus(command, now_s);
  else if (what == "focus_off") focus_until_s_.reset();  // the pulse that is under way ends by itself
  else if (what == "start") start(command, now_s);
  else if (what == "pause") {
    pause_asked_ = true;
    send_now(feed_hold());
  } else if (what == "resume") {
    require_confirmation(command, "The machine continues with its laser or spindle on");
    pause_asked_ = false;
    send_now(cycle_start());
    phase_ = MachinePhase::running;  // until the next report: lines may follow at once
  } else if (what == "send") send_by_hand(command);
  else override_speeds(command);
}

void GrblDriver::home(const Json& command, double now_s) {
  require_confirmation(command, "The head moves to its switches");
  if (const std::string sentence = machine_.runs_by_itself(); !sentence.empty()) refuse("home", sentence);
  refused_.reset();
  focus_until_s_.reset();
  // A light pulse is waited for; other unanswered lines are dropped by a reset.
  if (needs_reset_ || (!stream_.empty() && !pulse_)) after_banner_ = {"$H"}, reset(now_s);
  else queue("$H");
}

double GrblDriver::speed_mm_per_min(const Json& command, double fallback_mm_per_s) const {
  return 60 * number_of(command, "speed_mm_per_s", 0.01, 2000, fallback_mm_per_s);
}

void GrblDriver::jog(const Json& command) {
  std::string words;
  for (const auto& [name, letter] : {std::pair{"x_mm", 'X'}, std::pair{"y_mm", 'Y'}, std::pair{"z_mm", 'Z'}})
    if (const double mm = number_of(command, name, -max_grbl_distance_mm, max_grbl_distance_mm, 0); mm != 0)
      words += letter + decimal(mm);
  if (words.empty()) refuse("x_mm", "A jog needs x_mm, y_mm or z_mm.");
  focus_until_s_.reset();
  if (by_hand_.size() > 8) return;  // a key held down repeats faster than the head moves
  queue("$J=G91G21" + words + "F" + decimal(speed_mm_per_min(command, absent_number)));
}

void GrblDriver::go_to(const Json& command) {
  GcodeBounds bounds;
  bounds.add({number_of(command, "x_mm", -max_grbl_distance_mm, max_grbl_distance_mm, absent_number),
              number_of(command, "y_mm", -max_grbl_distance_mm, max_grbl_distance_mm, absent_number), 0});
  select_job_system();
  check_reach(bounds);
  focus_until_s_.reset();
  queue("$J=G90G21X" + decimal(bounds.low_mm[0]) + "Y" + decimal(bounds.low_mm[1]) + "F" +
        decimal(speed_mm_per_min(command, 50)));
}

void GrblDriver::frame(const Json& command) {
  require_confirmation(command, "The head moves once around the job, laser off");
  const std::array<double, 4> b = machines_detail::bounds_of(command);
  GcodeBounds bounds;
  bounds.add({b[0], b[1], 0});
  bounds.add({b[2], b[3], 0});
  select_job_system();
  check_reach(bounds);
  focus_until_s_.reset();
  const std::string speed = "F" + decimal(speed_mm_per_min(command, 50));
  for (const auto& [x, y] : machines_detail::corners_around(b))
    queue("$J=G90G21X" + decimal(x) + "Y" + decimal(y) + speed);
}

void GrblDriver::select_job_system() {
  if (machine_.work_system() == 54) return;
  queue("G54");
  machine_.follow("G54");
  offset_mm_ = machine_.offset_mm(54);
}

void GrblDriver::set_origin(const Json& command) {
  select_job_system();
  if (command.value("at", Json("head")) == "corner") {
    if (!homes() || !place_known())
      refuse("at", "The machine does not know where the bed's corner is until it is homed: home it first.");
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

bool GrblDriver::waits(std::string_view beginning) const {
  return stream_.waits_for(beginning) || std::any_of(by_hand_.begin(), by_hand_.end(), [&](const std::string& line) {
           return line.starts_with(beginning);
         });
}

bool GrblDriver::waits_for_motion() const {
  return stream_.waits_for_motion() || std::any_of(by_hand_.begin(), by_hand_.end(), moves_head);
}

void GrblDriver::send_by_hand(const Json& command) {
  std::string line = machines_detail::line_of(command, 78);
  std::erase_if(line, [](char c) { return c == ' ' || c == '\t'; });
  std::transform(line.begin(), line.end(), line.begin(),
                 [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
  if (line == "?") return send_now(ask_report());
  if (line.find_first_of("!~?") != std::string::npos)
    refuse("line", "Use the buttons to pause and to continue, because the program checks that the machine obeys them.");
  const LineEffect effect = effect_of(line);
  if (effect.moves || effect.fires)
    require_confirmation(command, effect.fires ? "The line \"" + line + "\" may turn the laser or spindle on"
                                               : "The line \"" + line + "\" moves the machine");
  if (effect.fires && is_laser()) {
    if (setting(32, 1) != 1) refuse("line", "Laser mode is off in the machine: send $32=1 first.");
    line = with_dynamic_power(line);  // dark at rest; Focus has a light of its own
  }
  // GRBL takes "$H" with anything behind it for homing that never ends (system.c), but in builds that home single axes.
  if (line.starts_with("$H") && line != "$H" && !machine_.has_option('H'))
    refuse("line", "This machine homes all its axes at once: send $H.");
  if (line.starts_with("$H") && !homes()) refuse("line", "Homing is not switched on in this machine ($22).");
  if (const std::string sentence = machine_.runs_by_itself(); line.starts_with("$H") && !sentence.empty())
    refuse("line", sentence);
  focus_until_s_.reset();
  light_by_hand_ = light_by_hand_ || effect.fires;
  queue(line);
  const bool changes_settings =
      line.starts_with("$RST") ||
      (line.starts_with("$") && line.find('=') != std::string::npos && !line.starts_with("$J"));
  if (!changes_settings) return;
  machine_.forget_settings();  // asked for again, so that what is known stays true
  queue("$$");
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

}  // namespace formwright
