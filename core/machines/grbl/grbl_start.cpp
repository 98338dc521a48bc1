// SPDX-License-Identifier: GPL-3.0-or-later
// Whether a job may begin on a GRBL machine, and how it does.
#include <algorithm>
#include <cmath>

#include "machines/grbl/grbl_driver.h"

namespace formwright {

using machines_detail::decimal;
using machines_detail::number_of;
using machines_detail::refuse;
using machines_detail::require_confirmation;

double GrblDriver::reach_low(int axis) const {
  // Machine coordinates run from the switches to 0 or, where homing sets the origin, from 0 away from them.
  const bool origin_at_switch = machine_.has_option('Z');
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
    if (!homes_axis(axis) || !axes_known_[axis] || !offset_mm_) continue;
    const double low = reach_low(static_cast<int>(axis)), high = low + bed[axis], offset = (*offset_mm_)[axis];
    if (bounds.low_mm[axis] + offset < low - 1e-3 || bounds.high_mm[axis] + offset > high + 1e-3)
      refuse("job", "The job would leave the bed in " + name + ": from the origin it may go from " +
                        decimal(low - offset) + " to " + decimal(high - offset) + " mm, and goes from " +
                        decimal(bounds.low_mm[axis]) + " to " + decimal(bounds.high_mm[axis]) +
                        " mm. Move the origin or the job.");
  }
}

/// Does the line move something, so that it takes a block of the planner?
static bool takes_a_block(std::string_view line) { return line.find_first_of("XYZIJK") != std::string_view::npos; }

int GrblDriver::careful_line() const {
  if (!job_) return 1;
  // All before the planner's blocks, and the move that waits for a free one, is done; from there back to where a travel
  // begins, so that a cut starts anew and not in its middle.
  int index = job_->acknowledged, blocks = machine_.planner_blocks() + 1;
  while (index > 0 && blocks > 0) blocks -= takes_a_block(program_.line(--index)) ? 1 : 0;
  return program_.number(program_.rapid_before(index));
}

std::vector<std::string> GrblDriver::lines_back_to(int index) const {
  const GcodeState s = program_.state_before(index);
  std::vector<std::string> lines;
  if (s.plane != 17 || s.work_system != 54)
    lines.push_back("G" + std::to_string(s.plane) + "G" + std::to_string(s.work_system));
  const bool mill = options_.tool == MachineTool::mill;
  if (mill && s.moved[2]) lines.push_back("G0Z" + decimal(program_.bounds().high_mm[2]));
  // On an axis that the job has not named yet the head stays where it is; jobs that count from here begin at 0.
  std::string move;
  const bool any = s.moved[0] || s.moved[1], from_zero = any && program_.from_here();
  if (s.moved[0] || from_zero) move += "X" + decimal(s.position_mm[0]);
  if (s.moved[1] || from_zero) move += "Y" + decimal(s.position_mm[1]);
  if (!move.empty()) lines.push_back("G0" + move);
  if (s.mist) lines.push_back("M7");
  if (s.flood) lines.push_back("M8");
  if (s.spindle != 5) lines.push_back(as_sent("M" + std::to_string(s.spindle)) + "S" + decimal(s.power));
  if (mill && s.spindle != 5) lines.push_back("G4P3");
  const std::string feed = s.feed_mm_per_min > 0 ? "F" + decimal(s.feed_mm_per_min) : "";
  if (mill && s.moved[2]) lines.push_back("G1Z" + decimal(s.position_mm[2]) + (feed.empty() ? "F100" : feed));
  if (s.motion <= 1 && (s.motion == 0 || !feed.empty())) lines.push_back("G" + std::to_string(s.motion) + feed);
  if (s.inches) lines.push_back("G20");
  if (s.relative) lines.push_back("G91");
  return lines;
}

std::string GrblDriver::unknown_place() const {
  for (std::size_t axis = 0; axis < 2; ++axis)
    if (moves_axis_[axis] && !axes_known_[axis])
      return homes_axis(axis)
                 ? "Where the head stands is unknown: home the machine first."
                 : "Where the head stands is unknown: jog to the material's corner and set the origin first.";
  if (moves_axis_[2] && !axes_known_[2])
    return homes_axis(2) ? "How high the tool stands is unknown: home the machine first."
                         : "Set z: the job moves up and down, and where z is 0 is unknown. Jog the tool down to the "
                           "material's top and set z there.";
  return "";
}

/// What the machine's own settings and state would make of the job.
void GrblDriver::check_settings() const {
  const double mode = setting(32, is_laser() ? 1 : 0), high = setting(30, 1000), low = setting(31, 0);
  if (program_.fires() && is_laser() && mode != 1)
    refuse("start",
           "Laser mode is off in the machine, so the beam would stay on at every corner and travel: send $32=1 first.");
  if (program_.fires() && !is_laser() && mode != 0)
    refuse("start", "Laser mode is on in the machine, so the spindle would stop at every travel: send $32=0 first.");
  if (program_.fires() && is_laser() && low >= high)
    refuse("start", "The machine's smallest power ($31=" + decimal(low) + ") is not below its largest ($30=" +
                        decimal(high) + "), so every power would be the largest: send $31=0 first.");
  if (program_.fires() && is_laser() && power_wanted_.max_power > high)
    refuse("start", "Line " + std::to_string(power_wanted_.max_power_line) + " asks for S" +
                        decimal(power_wanted_.max_power) + ", and the machine's full power is S" + decimal(high) +
                        " ($30): set the profile's full power to " + decimal(high) + " and make the job anew.");
  if (const std::string sentence = machine_.keeps_beam_on(); program_.fires() && is_laser() && !sentence.empty())
    refuse("start", sentence);
  if (program_.fires() && is_laser() && hold_keeps_beam())
    refuse("start",
           "The machine keeps the beam on when it is paused ($63), and the job burns at rest: send $63=3 first.");
  if (const std::string sentence = machine_.runs_by_itself(); !sentence.empty()) refuse("start", sentence);
  if (const std::string sentence = machine_.misplaces(); !sentence.empty()) refuse("start", sentence);
}

/// A job whose first cut begins at 0 without saying so would cut a line to it from wherever the head is.
void GrblDriver::require_first_cut_placed(int index) const {
  constexpr double at_origin_mm = 0.1;  // machines stop at whole steps
  for (std::size_t axis = 0; index == 0 && axis < 2; ++axis)
    if (unplaced_[axis] && (!work_mm_ || std::abs((*work_mm_)[axis]) > at_origin_mm))
      refuse("start", "The job cuts before it says where that begins: move to x 0, y 0 first, or set the origin here.");
}

void GrblDriver::start(const Json& command, double now_s) {
  std::string happens = "The machine moves";
  if (program_.fires()) happens += " and its laser or spindle turns on";
  if (is_laser() && !dynamic_power())
    happens += ", line " + std::to_string(power_wanted_.rest_line) +
               " burns at rest (M3 with G4), and the laser stays on there if the connection ends";
  require_confirmation(command, happens);
  const bool z_here = asks_z() && machines_detail::z_choice_of(command) == machines_detail::ZChoice::here;
  check_settings();
  const int from_line = static_cast<int>(number_of(command, "from_line", 1, 1e9, 1));
  const int index = program_.index_of(from_line);
  if (index >= program_.line_count())
    refuse("from_line", "The job has " + std::to_string(program_.number(program_.line_count() - 1)) +
                            " lines: go on from one of them.");
  require_head_at_origin(program_, index, work_mm_);
  require_first_cut_placed(index);
  select_job_system();
  check_reach(program_.bounds());
  if (z_here && !machine_mm_) refuse("z", "The machine has not reported where its tool stands: try again in a second.");
  const bool z_known = homes_axis(2) && axes_known_[2] && (z_here || offset_mm_);
  if (const double travel_mm = setting(132, 0); travel_mm > 0)
    require_z_reach(
        program_.bounds(), travel_mm,
        z_known ? std::optional(reach_low(2) - (z_here ? (*machine_mm_)[2] : (*offset_mm_)[2])) : std::nullopt);
  focus_until_s_.reset();
  refused_.reset();
  pause_asked_ = closing_sent_ = light_by_hand_ = false;
  job_ = MachineJob{
      program_name_, program_.line_count(), index, index, index > 0 ? program_.number(index - 1) : 0, now_s, 0, ""};
  first_line_ = next_line_ = index;
  progress_s_ = answered_s_ = now_s;
  idle_since_s_ = -1;
  queue("M5");
  if (z_here) {
    queue("G10L20P1Z0");
    expect_origin({std::nullopt, std::nullopt, (*machine_mm_)[2]});
  }
  queue("G21G90G94G17G54");
  queue("G0S0");
  if (index > 0)
    for (const std::string& line : lines_back_to(index)) queue(line);
}

Json GrblDriver::warnings() const {
  Json sentences = Json::array();
  if (connection_ != MachineConnection::ready) return sentences;
  for (const std::string& sentence : {machine_.runs_by_itself(), machine_.misplaces()})
    if (!sentence.empty()) sentences.push_back(sentence);
  if (const std::string sentence = machine_.keeps_beam_on(); is_laser() && !sentence.empty())
    sentences.push_back(sentence);
  if (is_laser() && setting(32, 1) != 1)
    sentences.push_back("Laser mode is off in the machine: send $32=1 before a job.");
  if (program_.line_count() == 0 || !program_.fires()) return sentences;
  if (is_laser() && power_wanted_.constant && dynamic_power())
    sentences.push_back("The job's M3 is sent as M4, so that the laser is off whenever the head stands still.");
  if (is_laser() && !dynamic_power())
    sentences.push_back("Line " + std::to_string(power_wanted_.rest_line) +
                        " burns while the head rests (M3 with G4), so the job is sent with M3: the laser stays on if "
                        "the connection ends there.");
  if (!is_laser() && power_wanted_.max_power > setting(30, 1000))
    sentences.push_back("Line " + std::to_string(power_wanted_.max_power_line) + " asks for S" +
                        decimal(power_wanted_.max_power) + "; the machine's fastest is S" + decimal(setting(30, 1000)) +
                        " ($30).");
  return sentences;
}

std::string GrblDriver::when_connection_ends() const {
  if (program_.line_count() == 0) return "";
  const std::string begins =
      "If the computer, the cable or this program fails, the machine finishes the moves it has received, a few seconds at most";
  if (!program_.fires()) return begins + ", and stops.";
  if (!is_laser()) return begins + ", and then stops with its spindle running until somebody switches it off.";
  return dynamic_power() ? begins + ", and then stops with its laser off (M4 in laser mode)."
                         : begins + ", and may then stop with its laser ON (M3): stay beside it.";
}

}  // namespace formwright
