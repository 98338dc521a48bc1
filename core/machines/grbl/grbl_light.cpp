// SPDX-License-Identifier: GPL-3.0-or-later
// Where a GRBL machine's beam or spindle is on, and that it goes out.
//
// The focus light goes out by itself: it is a row of pulses, each sent whole and ending with its own M5, so that nobody
// has to be there to end it. Each is as good with any one of its bytes lost: no line becomes a longer dwell or another
// power, and behind M3 both M5 and G0 put a laser out (gcode.c, "M3 constant power laser requires planner syncs").
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

constexpr double pulse_s = 1;
constexpr double stray_s = 1.5;  // two reports at rest
constexpr int max_dark_refused = 3;
constexpr double settling_s = 0.5;  // an answer takes a tenth of that
constexpr char jog_cancel_command = static_cast<char>(0x85), power_override_reset = static_cast<char>(0x99);

}  // namespace

bool GrblDriver::waits_for_dark(const std::string& line, double now_s) {
  const bool moves = line.starts_with("$J") || (line.starts_with("$H") && phase_ != MachinePhase::alarm);
  if (!moves || dark_) return false;
  if (!darkening_ && phase_ != MachinePhase::jogging && stream_.has_room(2, false)) send({"M5"}, now_s);
  return true;
}

/// Called for every line that is sent.
void GrblDriver::heed_light(const std::string& line) {
  if (line == "M5") darkening_ = true, light_behind_dark_ = false;
  const LineEffect effect = effect_of(line);
  if (line.starts_with("$") ? line.starts_with("$N") : effect.fires || effect.moves)
    dark_ = false, light_behind_dark_ = true;
}

void GrblDriver::hear_dark(std::optional<int> error, double now_s) {
  darkening_ = false;
  if (!error) {
    dark_ = !light_behind_dark_;
    if (dark_ && power_) power_ = 0;
    light_by_hand_ = light_by_hand_ && light_behind_dark_;
    dark_refused_ = 0;
    ended_badly_ = false;
    return;
  }
  ++dark_refused_;
  by_hand_.clear();  // what waited for it
  if (!job_active()) note("The machine refused to turn its laser or spindle off (M5).", now_s);
}

void GrblDriver::watch_light(double now_s) {
  const bool rests = phase_ == MachinePhase::idle, jogs = phase_ == MachinePhase::jogging;
  const bool watched = connection_ == MachineConnection::ready && stopping_ == Stopping::no && !job_active() &&
                       !pulse_ && !light_by_hand_ && (rests || jogs);
  if (!watched || power_.value_or(0) <= 0 || !is_laser()) {
    stray_since_s_ = -1;
  } else if (stray_since_s_ < 0) {
    stray_since_s_ = now_s;
    dark_ = false;
    by_hand_.clear();
    note("The machine reports its laser on though nothing asked for it: it is turned off.", now_s);
    if (jogs) cancel_jog(now_s);
  } else if (now_s - stray_since_s_ > stray_s) {
    stray_since_s_ = -1;
    note("The laser did not turn off: the machine is reset. If the beam is still on, switch the machine off.", now_s);
    return reset(now_s);
  }
  if (watched && rests && !dark_ && !darkening_ && (is_laser() || ended_badly_) && dark_refused_ < max_dark_refused &&
      identifying_ == 0 && by_hand_.empty() && stream_.empty())
    queue("M5");
}

/// At rest it is not sent: grblHAL empties its buffer (protocol.c CMD_JOG_CANCEL), and with it the M5 of a pulse.
void GrblDriver::cancel_jog(double now_s) {
  if (pulse_ || (phase_ != MachinePhase::jogging && !stream_.waits_for("$J"))) return;
  send_now(jog_cancel_command);
  if (speaks_grblhal() && !stream_.empty()) jog_cancelled_s_ = now_s;
}

void GrblDriver::settle_cancelled_jog(double now_s) {
  if (jog_cancelled_s_ < 0) return;
  if (phase_ == MachinePhase::jogging) {
    if (now_s - jog_cancelled_s_ <= settling_s) return;
    // A jog that waited for room in the planner is carried out behind the cancelled ones (motion_control.c mc_line).
    send_now(jog_cancel_command);
    jog_cancelled_s_ = now_s;
    return;
  }
  const bool quiet = phase_ == MachinePhase::idle && idle_since_s_ >= 0 &&
                     now_s - std::max({jog_cancelled_s_, progress_s_, idle_since_s_}) > settling_s;
  if (!stream_.empty() && !quiet) return;
  stream_.clear();
  jog_cancelled_s_ = -1;
}

void GrblDriver::focus(const Json& command, double now_s) {
  const double power = number_of(command, "power_percent", 0, options_.focus_power_percent, absent_number);
  require_confirmation(command, "The laser shines at " + decimal(power) + " % without moving: eyes protected");
  if (const std::string sentence = machine_.keeps_beam_on(); !sentence.empty()) refuse("focus", sentence);
  if (setting(32, 1) != 1)
    refuse("focus", "Laser mode is off in the machine: send $32=1 first, so that the light goes out by itself.");
  // spindle_control.c spindle_compute_pwm_value: then every S, 0 too, is full power.
  if (setting(31, 0) >= setting(30, 1000))
    refuse("focus", "The machine's smallest power ($31) is not below its largest ($30): set them first.");
  const double s = 0.01 * power * setting(30, 1000);
  focus_power_ = s >= 1 ? decimal(std::floor(s)) : decimal(s);
  send_now(power_override_reset);  // or it would multiply what is allowed
  pulses_ = 0;
  focus_until_s_ = now_s + options_.focus_seconds;
}

void GrblDriver::send_pulse(double now_s) {
  if (!focus_until_s_ || phase_ != MachinePhase::idle || !stream_.empty() || !by_hand_.empty()) return;
  if (pulses_ > 0 && now_s + pulse_s > *focus_until_s_) return focus_until_s_.reset();
  ++pulses_;
  pulse_ = true;
  dark_ = light_behind_dark_ = false;
  std::string bytes;
  // In laser mode the beam is on at rest only with M3 and a cutting motion. The empty line ends what grblHAL does
  // behind a refused one: it would refuse the M5, too (protocol.c).
  for (const std::string& line : {std::string("G1F1000"), "M3S" + focus_power_, "G4P" + decimal(pulse_s), std::string(),
                                  std::string("M5"), std::string("G0")}) {
    say("sent", line, now_s);
    bytes += line + "\n";
    stream_.sent({line, -1, false, dwell_s(line), true});
  }
  progress_s_ = now_s;
  write(bytes);
}

void GrblDriver::hear_pulse(const GrblStream::Line& line, std::optional<int> error, double now_s) {
  if (error) {
    focus_until_s_.reset();
    note("The machine refused a line of the focus light: it is reset, so that the light is out.", now_s);
    return reset(now_s);
  }
  if (line.text == "M5") {
    dark_ = !light_behind_dark_;  // a line by hand may stand behind the pulse
    if (dark_) power_ = 0;
  }
  if (line.text == "G0") pulse_ = false;
}

Json GrblDriver::laser_on() const {
  if (connection_ != MachineConnection::ready) return nullptr;
  if (pulse_) return true;
  if (power_) return *power_ > 0 || (!is_laser() && spindle_on_.value_or(false));
  return spindle_on_ ? Json(*spindle_on_) : Json(nullptr);
}

}  // namespace formwright
