// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/grbl/grbl_driver.h"

#include <algorithm>

#include "machines/grbl/grbl_words.h"

namespace formwright {
namespace {

constexpr char soft_reset = 0x18;
constexpr std::size_t longest_line = 78;  // GRBL's line buffer has 80 with both ends
constexpr double boot_s = 1.0;            // boards that reset on opening print their banner within this
constexpr double greeting_s = 10, silence_s = 3, homing_s = 180;
constexpr double asking_s = 0.2, asking_idle_s = 0.5;  // at most 5 Hz: reports cost the machine time
constexpr double hold_before_reset_s = 0.5, reset_s = 2;
constexpr double lost_answer_s = 3;
constexpr double reset_again_s = 0.4;
constexpr int max_resets = 4;

}  // namespace

void GrblDriver::opened(double now_s) {
  *this = GrblDriver(options_);
  connection_ = MachineConnection::greeting;
  opened_s_ = heard_s_ = now_s;
}

void GrblDriver::closed(double now_s) {
  if (connection_ == MachineConnection::closed) return;
  if (job_active()) {
    end_job("cut_off", now_s);
    note("The connection to the machine was lost during the job. Make sure that the laser is off.", now_s);
  }
  drop_output();
  stream_.clear();
  by_hand_.clear();
  after_banner_.clear();
  identifying_ = 0;
  forget_half_lines();
  stopping_ = Stopping::no;
  focus_until_s_.reset();
  dark_ = darkening_ = pulse_ = light_by_hand_ = false;
  jog_cancelled_s_ = -1;
  connection_ = MachineConnection::closed;
  phase_ = MachinePhase::unknown;
  lose_position();
  machine_mm_ = work_mm_ = std::nullopt;
}

void GrblDriver::received(ByteView bytes, double now_s) {
  if (connection_ == MachineConnection::closed) return;
  for (const std::string& line : lines_in(bytes)) hear(line, now_s);
  pump(now_s);
}

void GrblDriver::stop(const char* how, double now_s) {
  end_job(how, now_s);
  by_hand_.clear();
  after_banner_.clear();
  drop_output();
  lose_position();
  focus_until_s_.reset();
  ended_badly_ = true;
  if (stopping_ != Stopping::no) return;
  stopping_ = Stopping::holding;
  stopping_s_ = now_s;
  // A hold in the middle of a pulse would keep it on in machines that do not darken their laser then; a reset ends it.
  if (!pulse_) send_now(feed_hold());
  // A hold turns the beam off in laser mode only; homing, sleep and silence hear nothing but a reset.
  const bool beam_stays = is_laser() && (setting(32, 1) != 1 || hold_keeps_beam());
  if (homing_ || beam_stays || pulse_ || phase_ == MachinePhase::sleep || connection_ != MachineConnection::ready)
    reset(now_s);
}

void GrblDriver::reset(double now_s) {
  stopping_ = Stopping::resetting;
  stopping_s_ = reset_sent_s_ = now_s;
  resets_ = 1;
  stream_.clear();
  dark_ = darkening_ = pulse_ = false;
  send_now(soft_reset);
}

void GrblDriver::send(GrblStream::Line line, double now_s) {
  say("sent", line.text, now_s);
  write(line.text + "\n");
  if (line.text == "$H") homing_ = true, homing_since_s_ = now_s, phase_ = MachinePhase::homing, lose_position();
  if (line.text.starts_with("$J") && phase_ != MachinePhase::jogging)
    phase_ = MachinePhase::jogging, asked_s_ = now_s;  // before a report tells it
  if (stream_.empty()) progress_s_ = now_s;
  heed_light(line.text);
  stream_.sent(std::move(line));
}

void GrblDriver::pump(double now_s) {
  if (connection_ == MachineConnection::closed || stopping_ != Stopping::no || needs_reset_ || pendant_) return;
  if (jog_cancelled_s_ >= 0) return;
  if (!pump_by_hand(now_s)) return;
  if (job_active()) pump_job(now_s);
  else send_pulse(now_s);
}

/// True where nothing waits behind it.
bool GrblDriver::pump_by_hand(double now_s) {
  while (!by_hand_.empty()) {
    const std::string line = by_hand_.front();
    const bool alone = writes_eeprom(line);
    if (waits_for_dark(line, now_s)) return false;
    if (phase_ == MachinePhase::jogging && !line.starts_with("$J"))
      return false;  // G-code is locked out until the jog has ended
    if (!stream_.has_room(line.size(), alone)) return false;
    // grblHAL answers every line behind a refused one by the same error, until an empty one (protocol.c).
    if (refused_before_ && !line.starts_with("$")) {
      send({}, now_s);
      refused_before_ = false;
      continue;
    }
    by_hand_.pop_front();
    send({line, -1, alone, line == "$H" ? homing_s : dwell_s(line)}, now_s);
  }
  return true;
}

void GrblDriver::pump_job(double now_s) {
  if (pause_asked_ || phase_ == MachinePhase::paused || phase_ == MachinePhase::pausing || phase_ == MachinePhase::door)
    return;
  // What leads to its first line is answered before that.
  if (next_line_ == first_line_ && !stream_.empty()) return;
  while (next_line_ < program_.line_count()) {
    const std::string line = as_sent(program_.line(next_line_));
    const bool alone = writes_eeprom(line);
    if (!stream_.has_room(line.size(), alone)) return;
    send({line, next_line_++, alone, dwell_s(line)}, now_s);
    job_->sent = next_line_;
  }
  if (!closing_sent_ && stream_.has_room(2, false)) {
    closing_sent_ = true;
    send({"M5"}, now_s);
  }
}

void GrblDriver::tick(double now_s) {
  if (connection_ == MachineConnection::closed) return;
  const bool booting =
      connection_ == MachineConnection::greeting && machine_.firmware().empty() && now_s - opened_s_ < boot_s;
  const bool rests = phase_ == MachinePhase::idle && !job_active() && stream_.empty() && !focus_until_s_;
  if (!booting && now_s - asked_s_ >= (rests ? asking_idle_s : asking_s)) {
    send_now(ask_report());
    asked_s_ = now_s;
  }
  if (stopping_ == Stopping::holding && now_s - stopping_s_ > hold_before_reset_s) reset(now_s);
  // Behind an alarm the firmware forgets a reset that came before it was ready to wait for one (protocol.c
  // protocol_exec_rt_system).
  if (stopping_ == Stopping::resetting && needs_reset_ && resets_ < max_resets && now_s - reset_sent_s_ > reset_again_s)
    send_now(soft_reset), reset_sent_s_ = now_s, ++resets_;
  if (stopping_ == Stopping::resetting && now_s - stopping_s_ > reset_s) {
    stopping_ = Stopping::no;
    note(alarm_ && waits_for_reset(*alarm_, machine_.kind())
             ? "What raised the alarm is still there: end it, then unlock or home again."
             : "The machine did not answer the reset. If it still moves, switch it off.",
         now_s);
  }
  watch_silence(now_s);
  settle_cancelled_jog(now_s);
  pump(now_s);
}

void GrblDriver::watch_silence(double now_s) {
  const double patience = connection_ == MachineConnection::greeting ? greeting_s : homing_ ? homing_s : silence_s;
  if (connection_ != MachineConnection::silent && now_s - heard_s_ > patience) {
    connection_ = MachineConnection::silent;
    homing_ = false;
    note(
        machine_.firmware().empty()
            ? "Nothing answers: check that the machine is on, the controller chosen, and the line speed (115200 for most)."
            : "The machine does not answer any more: check the cable. If it moves, switch it off.",
        now_s);
    focus_until_s_.reset();
    if (job_active()) stop("cut_off", now_s);
  }
  // At rest with lines unanswered: an answer, or a line, was lost. Waiting longer would wait for ever.
  const double since = std::max(progress_s_, idle_since_s_);
  if (stream_.empty() || phase_ != MachinePhase::idle || idle_since_s_ < 0 || homing_ ||
      now_s - since <= lost_answer_s + stream_.patience_s())
    return;
  note("The machine stands still, but did not answer every line: data were lost on the way. Check the cable.", now_s);
  if (job_active()) return stop("failed", now_s);
  // What is in its buffer may lack its end, and would spoil, or be spoilt by, what follows.
  if (pulse_) return reset(now_s);
  stream_.clear();
  by_hand_.clear();
  identifying_ = 0;
  dark_ = darkening_ = false;
  focus_until_s_.reset();
  connection_ = MachineConnection::ready;
}

std::unique_ptr<PreparedJob> GrblDriver::prepare(ByteView job) const {
  GrblJob read;
  read.program = GcodeProgram::read(job, longest_line);
  require_runnable(read.program, {GcodeDialect::grbl});
  read.power = laser_power_of(read.program);
  read.unplaced = unplaced_at_first_cut(read.program);
  read.moves_axis = read.program.state_before(read.program.line_count()).moved;
  read.mist_line = first_mist_line(read.program);
  return machines_detail::prepared(std::move(read));
}

void GrblDriver::load_prepared(const std::string& name, PreparedJob& job) {
  if (job_active()) machines_detail::refuse("job", "A job is running: stop it before another is loaded.");
  GrblJob& taken = machines_detail::program_in<GrblJob>(job);
  // Which letters the board has only the machine tells, and it may not have done so while the job was read.
  if (taken.mist_line > 0 && machine_.tells_options() && !machine_.has_option('M'))
    machines_detail::refuse("job", "Line " + std::to_string(taken.mist_line) +
                                       " turns on mist (M7), which this board has no output for: take that word out.");
  std::swap(program_, taken.program);
  power_wanted_ = taken.power;
  unplaced_ = taken.unplaced;
  moves_axis_ = taken.moves_axis;
  program_name_ = name;
  job_.reset();
}

Json GrblDriver::state(double now_s) const {
  const auto place = [&](const std::optional<std::array<double, 3>>& p) { return p ? Json(*p) : Json(nullptr); };
  const MachinePhase shown = stopping_ != Stopping::no                         ? MachinePhase::stopping
                             : pause_asked_ && phase_ == MachinePhase::running ? MachinePhase::pausing
                                                                               : phase_;
  Json state = common_state("grbl", connection_, shown, axes_known_, now_s);
  state["firmware"] = machine_.firmware();
  state["machine_mm"] = place(machine_mm_);
  state["work_mm"] = place(work_mm_);
  state["speed_mm_per_s"] = feed_mm_per_min_ / 60;
  state["power_percent"] = setting(30, 1000) > 0 ? 100 * power_.value_or(0) / setting(30, 1000) : 0;
  if (job_) state["job"]["careful_line"] = careful_line();
  if (alarm_) {
    const GrblWords words = grbl_alarm(*alarm_, machine_.kind());
    state["alarm"] = machines_detail::alarm_json(*alarm_, words.text, words.fix);
  }
  if (refused_)
    state["error"] = {{"code", refused_->code},
                      {"text", grbl_error(refused_->code, machine_.kind())},
                      {"line", refused_->line},
                      {"line_number", refused_->line_number}};
  state["laser_on"] = laser_on();
  state["warnings"] = warnings();
  state["when_connection_ends"] = when_connection_ends();
  if (asks_z() && connection_ == MachineConnection::ready)
    state["z_choice"] = machines_detail::z_choice_json(
        homes_axis(2) && axes_known_[2] && offset_mm_ ? std::optional((*offset_mm_)[2]) : std::nullopt, z_set_s_,
        now_s);
  state["can"] = possible_commands();
  return state;
}

}  // namespace formwright
