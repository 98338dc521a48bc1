// SPDX-License-Identifier: GPL-3.0-or-later
// What a person may ask of a Marlin machine, and when.
#include <algorithm>
#include <cmath>

#include "machines/marlin/marlin_driver.h"

namespace formwright {
namespace {

using machines_detail::absent_number;
using machines_detail::decimal;
using machines_detail::number_of;
using machines_detail::refuse;
using machines_detail::require_confirmation;

constexpr double max_marlin_distance_mm = 10000;
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
  if (place_.known()) add({"go_to", "frame"});
  if (options_.tool == MachineTool::laser) add({focus_until_s_ ? "focus_off" : "focus"});
  // A printer's own G-code homes it.
  if (now == MachinePhase::idle && program_.line_count() > 0 &&
      (place_.known() || options_.tool == MachineTool::printer))
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
    if ((what == "start" || what == "frame" || what == "go_to") && is_free() && !place_.known())
      refuse(what, "Where the head stands is unknown: home the machine first.");
    if (what == "start" && program_.line_count() == 0) refuse(what, "No job is loaded: choose one first.");
    machines_detail::refuse_in_phase(what, phase());
  }
  if (what != "jog") prepared_ = false;
  const auto speed = [&](double fallback) { return number_of(command, "speed_mm_per_s", 0.01, 2000, fallback); };
  if (what == "home") {
    require_confirmation(command, "The head moves to its switches");
    prepare_moves(now_s);
    queue("G28");
    settle(Settles::homing);
  } else if (what == "jog") jog(command, now_s);
  else if (what == "set_origin") set_origin(command, now_s);
  else if (what == "go_to") {
    GcodeBounds bounds;
    bounds.add({number_of(command, "x_mm", -max_marlin_distance_mm, max_marlin_distance_mm, absent_number),
                number_of(command, "y_mm", -max_marlin_distance_mm, max_marlin_distance_mm, absent_number), 0});
    check_reach(bounds);
    prepare_moves(now_s);
    move("G90", " X" + decimal(bounds.low_mm[0]) + " Y" + decimal(bounds.low_mm[1]), speed(50));
    settle(Settles::moving);
  } else if (what == "frame") {
    require_confirmation(command, "The head moves once around the job, laser off");
    const std::array<double, 4> b = machines_detail::bounds_of(command);
    GcodeBounds bounds;
    bounds.add({b[0], b[1], 0});
    bounds.add({b[2], b[3], 0});
    check_reach(bounds);
    prepare_moves(now_s);
    for (const auto& [x, y] : machines_detail::corners_around(b))
      move("G90", " X" + decimal(x) + " Y" + decimal(y), speed(50));
    settle(Settles::moving);
  } else if (what == "focus") {
    const double power = number_of(command, "power_percent", 0, options_.focus_power_percent, absent_number);
    require_confirmation(command, "The laser shines at " + decimal(power) + " % without moving: eyes protected");
    queue_dark();  // and out of an inline mode, in which M3 alone would light nothing until a move
    focus_line_ = "M3 S" + decimal(2.55 * power);
    focus_until_s_ = now_s + options_.focus_seconds;
    note("The laser shines in pulses of a quarter second, each of which ends by itself.", now_s);
  } else if (what == "focus_off") focus_off(now_s);
  else if (what == "start") start(command, now_s);
  else if (what == "pause") {
    paused_ = true;
    // What is planned is still done; a laser must not stay on where that ends.
    if (options_.tool == MachineTool::laser) queue("M5");
  } else if (what == "resume") {
    require_confirmation(command, "The machine continues with its laser or heaters on");
    resume();
  } else if (what == "send") {
    const std::string text = machines_detail::line_of(command, longest_by_hand);
    const LineEffect effect = effect_of(text);
    if (effect.moves || effect.fires)
      require_confirmation(command, "The line \"" + text + "\" may move the machine, heat it or turn its laser on");
    if (focus_until_s_) focus_off(now_s);
    if (effect.fires)
      queue("M400");  // a stop drops the moves that it would wait for, and it would shine where they end
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
    if (const double mm = number_of(command, name, -max_marlin_distance_mm, max_marlin_distance_mm, 0); mm != 0) {
      words += letter + decimal(mm);
      squared_mm += mm * mm;
    }
  if (words.empty()) refuse("x_mm", "A jog needs x_mm, y_mm or z_mm.");
  const double speed_mm_per_s = number_of(command, "speed_mm_per_s", 0.01, 2000, absent_number);
  if (by_hand_.size() >= 12) return;  // a key held down repeats faster than the head moves
  // One M5 for all that a held key brings: it waits for the move before, and the head would halt at every step.
  if (!prepared_ || phase() != MachinePhase::jogging) prepare_moves(now_s);
  prepared_ = true;
  move("G91", words, speed_mm_per_s);
  jogging_until_s_ =
      std::max(jogging_until_s_.value_or(0), now_s + jog_starts_s) + std::sqrt(squared_mm) / speed_mm_per_s;
}

void MarlinDriver::set_origin(const Json& command, double now_s) {
  zero_at_head(machines_detail::zero_words(command, " "), now_s);
}

void MarlinDriver::zero_at_head(const std::string& words, double now_s) {
  queue("M114");  // where that is in the machine's own coordinates
  queue("G92" + words);
  place_.expect_origin(words);  // known at once; the machine reports it only when it is asked again
  if (words.find('Z') != std::string::npos) z_set_s_ = now_s;
  ask_soon();
}

void MarlinDriver::resume() {
  paused_ = false;
  if (options_.tool != MachineTool::laser || next_line_ >= program_.line_count()) return;
  const GcodeState s = program_.state_before(next_line_);
  const MarlinPower power = marlin_power_before(program_, next_line_);
  if (power == MarlinPower::dynamic || power == MarlinPower::continuous) {
    queue(power == MarlinPower::dynamic ? "M4 I S0" : "M3 I S0");
    // A cut that goes on needs its power, others bring their own. With G1, because M3 would shine at rest where the
    // firmware knows no I.
    if (s.motion != 0) queue("G1 S" + decimal(s.power));
  } else if (s.spindle != 5) queue("M" + std::to_string(s.spindle) + " S" + decimal(s.power));
}

void MarlinDriver::check_reach(const GcodeBounds& bounds) const {
  const double bed[] = {limits_ ? limits_->high_mm[0] - limits_->low_mm[0] : options_.bed_x_mm,
                        limits_ ? limits_->high_mm[1] - limits_->low_mm[1] : options_.bed_y_mm};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    if (!bounds.named[axis]) continue;
    const std::string name(1, "xy"[axis]);
    const double goes_low = bounds.low_mm[axis], goes_high = bounds.high_mm[axis];
    if (goes_high - goes_low > bed[axis] + 1e-3)
      refuse("job", "The job is " + decimal(goes_high - goes_low) + " mm long in " + name + ", the machine reaches " +
                        decimal(bed[axis]) + " mm: make it smaller or turn it.");
    const auto origin = place_.origin_mm(axis);
    // A printer that tells no limits may count from its bed's middle.
    if (!origin || (!limits_ && !has_cutter())) continue;
    const double low = (limits_ ? limits_->low_mm[axis] : 0) - *origin, high = low + bed[axis];
    if (goes_low < low - 1e-3 || goes_high > high + 1e-3)
      refuse("job", "The job would leave the bed in " + name + ": from the origin it may go from " + decimal(low) +
                        " to " + decimal(high) + " mm, and goes from " + decimal(goes_low) + " to " +
                        decimal(goes_high) + " mm. Move the origin or the job.");
  }
}

void MarlinDriver::start(const Json& command, double now_s) {
  require_confirmation(command, options_.tool == MachineTool::printer
                                    ? "The printer heats up and moves"
                                    : "The machine moves and its laser or spindle turns on");
  if (number_of(command, "from_line", 1, 1e9, 1) > 1)
    refuse("from_line", "Only GRBL machines can continue a stopped job: start it again.");
  if (has_cutter()) {  // a printer's jobs home it themselves
    require_head_at_origin(program_, 0, place_.position_mm());
    check_reach(program_.bounds());
    const bool z_here = asks_z() && machines_detail::z_choice_of(command) == machines_detail::ZChoice::here;
    if (program_.bounds().named[2] && !place_.axes_known()[2] && !z_here)
      refuse("start",
             "The job moves z, and how high the tool stands is unknown: touch the stock with it and set the "
             "origin of z there.");
    prepare_moves(now_s);
    queue("G90");
    if (z_here) zero_at_head(" Z0", now_s);
  }
  refused_.reset();
  paused_ = rests_ = false;
  job_ = MachineJob{program_name_, program_.line_count(), 0, 0, 0, now_s, 0, ""};
  next_line_ = 0;
}

Json MarlinDriver::laser_on() const {
  if (options_.tool != MachineTool::laser) return false;
  if (focus_until_s_) return true;
  if (dark_ && !job_active()) return false;
  return nullptr;  // Marlin does not tell
}

Json MarlinDriver::state(double now_s) const {
  Json state = common_state("marlin", connection_, phase(), place_.axes_known(), now_s);
  state["firmware"] = firmware_;
  if (place_.position_mm()) state["machine_mm"] = state["work_mm"] = *place_.position_mm();
  state["laser_on"] = laser_on();
  if (options_.tool == MachineTool::laser) state["warnings"] = marlin_warnings(laser_use_, firmware_, no_m5_);
  if (program_.line_count() > 0)
    state["when_connection_ends"] = marlin_when_connection_ends(options_.tool, laser_use_, firmware_);
  if (asks_z()) state["z_choice"] = machines_detail::z_choice_json(place_.origin_mm(2), z_set_s_, now_s);
  state["temperatures"] = temperatures_;
  if (halted_)
    state["alarm"] = machines_detail::alarm_json(0, "The machine has halted: " + halt_text_,
                                                 "Find the cause, then switch it off and on again.");
  if (refused_)
    state["error"] = {{"code", 0},
                      {"text", "The machine does not know a command of the job."},
                      {"line", *refused_},
                      {"line_number", job_ ? job_->line_now : 0}};
  state["can"] = possible_commands();
  return state;
}

}  // namespace formwright
