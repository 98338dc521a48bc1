// SPDX-License-Identifier: GPL-3.0-or-later
// What a GRBL driver makes of what arrives.
#include <cstdlib>

#include "machines/grbl/grbl_driver.h"

namespace formwright {
namespace {

constexpr double asking_s = 0.2;
constexpr double homing_begins_s = 1;
constexpr int identifications = 3;

}  // namespace

void GrblDriver::hear(const std::string& line, double now_s) {
  heard_s_ = now_s;
  if (connection_ == MachineConnection::silent) {
    connection_ = identifying_ > 0 ? MachineConnection::greeting : MachineConnection::ready;
    note("The machine answers again.", now_s);
  }
  if (line.front() == '<') {
    if (const auto report = read_grbl_report(line)) hear_report(*report, now_s);
    return;
  }
  say("received", line, now_s);
  if (line == "ok") hear_answer(std::nullopt, now_s);
  else if (line.starts_with("error:")) hear_answer(std::atoi(line.c_str() + 6), now_s);
  else if (line.starts_with("ALARM:")) hear_alarm(std::atoi(line.c_str() + 6), now_s);
  else if (line.starts_with("Grbl ") || line.starts_with("GrblHAL ")) hear_banner(line, now_s);
  else machine_.hear(line);
  version_heard_ = version_heard_ || line.starts_with("[VER:");
  if (line.starts_with("[MSG:") && line.size() > 6) note(line.substr(5, line.size() - 6), now_s);
  // One byte of the ring buffer tells full from empty.
  if (line.starts_with("[OPT:") && machine_.buffer_bytes()) stream_.set_buffer_bytes(*machine_.buffer_bytes() - 1);
}

void GrblDriver::hear_banner(const std::string& line, double now_s) {
  machine_.hear_banner(line);
  machine_.reset_parser();
  const bool asked_for = stopping_ == Stopping::resetting || !after_banner_.empty() || needs_reset_;
  if (!asked_for && job_active()) {
    end_job("failed", now_s);
    note("The machine restarted by itself during the job: check its power supply and cable, then home it.", now_s);
  }
  if (!asked_for) lose_position();
  stream_.clear();
  by_hand_.clear();
  identifying_ = 0;
  stopping_ = Stopping::no;
  pause_asked_ = homing_ = needs_reset_ = false;
  focus_until_s_.reset();
  // A reset puts the beam out, but a line of the machine's own may follow it ($N0).
  dark_ = darkening_ = light_by_hand_ = pulse_ = refused_before_ = false;
  dark_refused_ = 0;
  ended_badly_ = true;
  if (phase_ != MachinePhase::alarm) phase_ = MachinePhase::unknown;
  asked_s_ = -1;
  if (connection_ == MachineConnection::greeting || !machine_.has_settings()) identify();
  for (const std::string& waiting : after_banner_) by_hand_.push_back(waiting);
  after_banner_.clear();
}

void GrblDriver::identify() {
  connection_ = MachineConnection::greeting;
  by_hand_ = {"$I", "$$", "$N", "$G", "$#"};
  identifying_ = static_cast<int>(by_hand_.size());
  version_heard_ = false;
  ++identified_;
}

void GrblDriver::hear_alarm(int code, double now_s) {
  alarm_ = code;
  phase_ = MachinePhase::alarm;
  homing_ = false;
  if (code != 2) lose_position();
  // What was sent to end an alarm goes on: grblHAL raises 11, FluidNC 14 right behind the banner that they waited for.
  std::erase_if(by_hand_, [](const std::string& line) { return line != "$H" && line != "$X"; });
  identifying_ = 0;  // the next report asks again what it is
  end_job("failed", now_s);
  stopping_ = Stopping::no;
  focus_until_s_.reset();
  needs_reset_ = code == 1 || code == 2 || waits_for_reset(code, machine_.kind());
  if (code == 1 || code == 2) reset(now_s);  // GRBL hears nothing else now, and does not even report
}

void GrblDriver::hear_answer(std::optional<int> error, double now_s) {
  const auto line = stream_.answered();
  if (error && refuses_foreign_line(line ? &*line : nullptr, *error)) return end_foreign_lines(now_s);
  if (!line) return;  // a fresh EEPROM prints error:7 before the banner; after a reset old answers may still come
  progress_s_ = answered_s_ = now_s;
  refused_before_ = refused_before_ || error;
  if (line->text == "$$") machine_.settings_answered();
  if (identifying_ > 0 && line->job_line < 0) {
    // A piece of a line that was left in the machine spoils the first that follows it.
    if (error && (line->text == "$I" || line->text == "$$") && identified_ < identifications) {
      by_hand_.clear();
      identifying_ = 0;
    } else if (--identifying_ == 0) {
      connection_ = MachineConnection::ready;
    }
    return;
  }
  if (line->pulse) return hear_pulse(*line, error, now_s);
  if (line->text == "$H") {
    homing_ = false;
    axes_known_ = error ? std::array<bool, 3>{} : machine_.homed_axes();
    if (!error) alarm_.reset(), refused_.reset();
  }
  if (line->text == "$X" && !error) alarm_.reset();
  // A report of rest may have passed it on the way: from here the machine moves, until a report says otherwise.
  if (line->text.starts_with("$J") && !error && phase_ == MachinePhase::idle)
    phase_ = MachinePhase::jogging, idle_since_s_ = -1;
  if (line->job_line < 0 && !job_active() && !error && !line->text.starts_with("$") && moves_head(line->text) &&
      phase_ == MachinePhase::idle)
    phase_ = MachinePhase::running, idle_since_s_ = -1;
  if (line->text.starts_with("$J") && error)  // what follows was to begin where this one was to lead
    std::erase_if(by_hand_, [](const std::string& waiting) { return waiting.starts_with("$J"); });
  if (line->text.starts_with("G10L20") && !error)
    for (std::size_t axis = 0; axis < 3; ++axis)
      axes_known_[axis] = axes_known_[axis] || (!homes_axis(axis) && line->text.find("XYZ"[axis]) != std::string::npos);
  const bool sets_job_origin = line->text.starts_with("G10L20P0") || line->text.starts_with("G10L20P1");
  if (sets_job_origin && !error && line->text.find('Z') != std::string::npos) z_set_s_ = now_s;
  if (line->text.starts_with("G10") && error) offset_mm_.reset();
  if (line->job_line < 0 && !error) machine_.follow(line->text);
  if (line->text == "M5" && line->job_line < 0) hear_dark(error, now_s);
  if (error) refused_ = {*error, line->text, line->job_line < 0 ? 0 : program_.number(line->job_line)};
  hear_job_answer(*line, error, now_s);
}

/// Until the machine has said what it is, lines of a program that ended before may still be in its buffer, and be
/// answered. GRBL counts a dwell as rest (motion_control.c, mc_dwell), so its reports do not show that.
bool GrblDriver::refuses_foreign_line(const GrblStream::Line* line, int error) const {
  constexpr int eeprom_failed = 7, max_resets = 3;
  if (stopping_ != Stopping::no || job_active() || foreign_resets_ >= max_resets || error == eeprom_failed)
    return false;
  if (line) return identifying_ > 0 && (!version_heard_ || line->text == "$I" || line->text == "$$");
  return identifying_ > 0 || (phase_ != MachinePhase::idle && phase_ != MachinePhase::alarm);
}

/// GRBL would act on the next line, from wherever the refused one was to lead.
void GrblDriver::end_foreign_lines(double now_s) {
  ++foreign_resets_;
  note("The machine refused a line that was sent before this connection, and was reset.", now_s);
  by_hand_.clear();
  identifying_ = 0;
  lose_position();
  reset(now_s);
}

void GrblDriver::hear_job_answer(const GrblStream::Line& line, std::optional<int> error, double now_s) {
  if (!job_active()) return;
  if (line.job_line >= 0) {
    job_->acknowledged = line.job_line + 1;
    job_->line_now = program_.number(line.job_line);
  }
  // GRBL would go on with the next line, from wherever this one was to lead.
  if (error) stop("failed", now_s);
}

void GrblDriver::hear_places(const GrblReport& report) {
  const auto inches = machine_.reports_inches();
  if (!inches) return;  // millimetres or not: nobody knows yet
  const double unit_mm = *inches ? 25.4 : 1;
  const auto in_mm = [&](std::array<double, 3> place) {
    for (double& x : place) x *= unit_mm;
    return place;
  };
  if (report.offset_mm && !origin_moves()) offset_mm_ = in_mm(*report.offset_mm);
  // Only some reports say it: in GRBL every tenth of a machine at rest (config.h REPORT_WCO_REFRESH_IDLE_COUNT), in
  // grblHAL none if $10 says so. The answer to $# says it as well.
  if (!offset_mm_ && !origin_moves()) offset_mm_ = machine_.offset_mm(machine_.work_system());
  if (report.machine_mm) machine_mm_ = in_mm(*report.machine_mm);
  if (report.work_mm) work_mm_ = in_mm(*report.work_mm);
  if (offset_mm_) {
    const auto combine = [&](const std::array<double, 3>& a, double sign) {
      return std::array<double, 3>{a[0] + sign * (*offset_mm_)[0], a[1] + sign * (*offset_mm_)[1],
                                   a[2] + sign * (*offset_mm_)[2]};
    };
    if (report.machine_mm) work_mm_ = combine(*machine_mm_, -1);
    else if (report.work_mm) machine_mm_ = combine(*work_mm_, 1);
  }
  if (report.feed_mm_per_min) feed_mm_per_min_ = unit_mm * *report.feed_mm_per_min;
}

void GrblDriver::hear_report(const GrblReport& report, double now_s) {
  asked_s_ = std::min(asked_s_, now_s);
  // The lock may be reported once more before the line that homes is read; homing that fails says ALARM.
  const bool not_begun = homing_ && report.phase == MachinePhase::alarm && now_s - homing_since_s_ < homing_begins_s;
  phase_ = not_begun ? MachinePhase::homing : report.phase;
  pendant_ = report.pendant.value_or(pendant_);
  if (report.tool_change && !tool_change_)
    note("The machine waits for a tool change: change the tool, then resume.", now_s);
  tool_change_ = report.tool_change;
  // A machine that works or is held reads no lines: what it is will be asked when it rests.
  const bool reads_lines = phase_ == MachinePhase::idle || phase_ == MachinePhase::alarm;
  const bool unknown_yet = connection_ == MachineConnection::greeting ||
                           (connection_ == MachineConnection::ready && !machine_.has_settings());
  if (unknown_yet && identifying_ == 0 && by_hand_.empty() && stream_.empty() && !job_active()) {
    if (reads_lines) identify();
    else connection_ = MachineConnection::ready;
  }
  hear_places(report);
  if (report.power) power_ = report.power;
  if (report.overrides) overrides_ = *report.overrides;
  if (report.spindle_on) spindle_on_ = report.spindle_on;
  if (phase_ == MachinePhase::alarm && alarm_.value_or(0) == 0) alarm_ = report.detail;
  if (phase_ != MachinePhase::idle) idle_since_s_ = -1;
  else if (idle_since_s_ < 0) idle_since_s_ = now_s;
  if (phase_ == MachinePhase::idle || phase_ == MachinePhase::running || phase_ == MachinePhase::jogging)
    alarm_.reset();
  if (stopping_ == Stopping::holding && phase_ != MachinePhase::pausing && phase_ != MachinePhase::running &&
      phase_ != MachinePhase::jogging)
    reset(now_s);  // at rest: from here a reset loses no steps
  if (phase_ == MachinePhase::paused || phase_ == MachinePhase::idle)
    pause_asked_ = pause_asked_ && phase_ == MachinePhase::paused;
  watch_light(now_s);
  if (!job_active() || stopping_ != Stopping::no || phase_ != MachinePhase::idle || !stream_.empty() ||
      !by_hand_.empty())
    return;
  // This report may have been on its way while the last answer was: only what was asked for later counts.
  if (closing_sent_ && now_s - answered_s_ > 1.5 * asking_s) end_job("done", now_s);
}

}  // namespace formwright
