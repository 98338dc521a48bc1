// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/grbl_driver.h"

#include <cmath>
#include <cstdlib>

#include "machines/grbl_words.h"

namespace formwright {
namespace {

constexpr char ask_report = '?', feed_hold = '!', soft_reset = 0x18;
constexpr std::size_t longest_line = 78;  // GRBL's line buffer has 80 with both ends
constexpr double boot_s = 1.0;            // boards that reset on opening print their banner within this
constexpr double greeting_s = 10, silence_s = 3, homing_s = 180;
constexpr double asking_s = 0.2, asking_idle_s = 0.5;  // at most 5 Hz: reports cost the machine time
constexpr double hold_before_reset_s = 0.5, reset_s = 2;
constexpr double lost_answer_s = 3;

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
    note("The machine is gone in the middle of the job. Make sure that the laser is off.", now_s);
  }
  drop_output();
  stream_.clear();
  by_hand_.clear();
  after_banner_.clear();
  identifying_ = 0;
  forget_half_lines();
  stopping_ = Stopping::no;
  focus_until_s_.reset();
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
  else if (line.front() == '[') hear_message(line, now_s);
  else if (line.front() == '$') {
    if (const std::size_t equals = line.find('='); equals != std::string::npos)
      settings_[std::atoi(line.c_str() + 1)] = std::strtod(line.c_str() + equals + 1, nullptr);
  }
}

void GrblDriver::hear_message(const std::string& line, double now_s) {
  if (line.starts_with("[VER:")) firmware_ = line.substr(5, line.find_first_of(":]", 5) - 5);
  if (line.starts_with("[OPT:")) {
    const std::string options = line.substr(5, line.size() - 6);
    const std::size_t comma = options.find(',');
    option_letters_ = options.substr(0, comma);
    const auto numbers =
        comma == std::string::npos ? std::vector<double>{} : numbers_between_commas(options.substr(comma + 1));
    // One byte of the ring buffer tells full from empty.
    if (numbers.size() >= 2 && numbers[1] >= 64)
      stream_.set_buffer_bytes(static_cast<int>(std::min(numbers[1], 65536.0)) - 1);
  }
  if (line.starts_with("[MSG:")) note(line.substr(5, line.size() - 6), now_s);
}

void GrblDriver::hear_banner(const std::string& line, double now_s) {
  firmware_ = line.substr(line.find(' ') + 1, line.find(' ', line.find(' ') + 1) - line.find(' ') - 1);
  const bool asked_for = stopping_ == Stopping::resetting || !after_banner_.empty() || limits_hit_;
  if (!asked_for && job_active()) {
    end_job("failed", now_s);
    note("The machine restarted by itself in the middle of the job: check its power supply and cable, then home it.",
         now_s);
  }
  if (!asked_for) lose_position();
  stream_.clear();
  by_hand_.clear();
  identifying_ = 0;
  stopping_ = Stopping::no;
  pause_asked_ = homing_ = limits_hit_ = false;
  focus_until_s_.reset();
  if (phase_ != MachinePhase::alarm) phase_ = MachinePhase::unknown;
  asked_s_ = -1;
  if (connection_ == MachineConnection::greeting || settings_.empty()) identify();
  for (const std::string& waiting : after_banner_) by_hand_.push_back(waiting);
  after_banner_.clear();
}

void GrblDriver::identify() {
  connection_ = MachineConnection::greeting;
  by_hand_ = {"$I", "$$"};
  identifying_ = 2;
}

void GrblDriver::hear_alarm(int code, double now_s) {
  alarm_ = code;
  phase_ = MachinePhase::alarm;
  limits_hit_ = code == 1 || code == 2;  // GRBL now waits for a reset and hears nothing else
  homing_ = false;
  if (code != 2) lose_position();
  by_hand_.clear();
  end_job("failed", now_s);
  stopping_ = Stopping::no;
}

void GrblDriver::hear_answer(std::optional<int> error, double now_s) {
  const auto line = stream_.answered();
  if (!line) return;  // a fresh EEPROM prints error:7 before the banner; after a reset old answers may still come
  progress_s_ = answered_s_ = now_s;
  if (identifying_ > 0 && line->job_line < 0 && --identifying_ == 0) connection_ = MachineConnection::ready;
  if (line->text == "$H") {
    homing_ = false;
    position_known_ = !error;
    if (!error) alarm_.reset(), refused_.reset();
  }
  if (line->text == "$X" && !error) alarm_.reset();
  // A report of rest may have passed it on the way: from here the machine moves, until a report says otherwise.
  if (line->text.starts_with("$J") && !error && phase_ == MachinePhase::idle)
    phase_ = MachinePhase::jogging, idle_since_s_ = -1;
  if (line->text.starts_with("G10L20") && !error && !homes()) position_known_ = true;
  if (line->text.starts_with("G10") && error) offset_mm_.reset();
  if (error) refused_ = {*error, line->text, line->job_line < 0 ? 0 : program_.number(line->job_line)};
  if (line->job_line < 0 || !job_active()) {
    if (error && job_active()) stop("failed", now_s);  // one of the lines that lead back to where a job goes on
    return;
  }
  job_->acknowledged = line->job_line + 1;
  job_->line_now = program_.number(line->job_line);
  // GRBL would go on with the next line, from wherever this one was to lead.
  if (error) stop("failed", now_s);
}

void GrblDriver::hear_report(const GrblReport& report, double now_s) {
  asked_s_ = std::min(asked_s_, now_s);
  phase_ = report.phase;
  // A machine that works or is held reads no lines: what it is will be asked when it rests.
  const bool reads_lines = phase_ == MachinePhase::idle || phase_ == MachinePhase::alarm;
  const bool unknown_yet =
      connection_ == MachineConnection::greeting || (connection_ == MachineConnection::ready && settings_.empty());
  if (unknown_yet && identifying_ == 0 && by_hand_.empty() && stream_.empty() && !job_active()) {
    if (reads_lines) identify();
    else connection_ = MachineConnection::ready;
  }
  if (report.offset_mm && !origin_moves()) offset_mm_ = report.offset_mm;
  if (report.machine_mm) machine_mm_ = report.machine_mm;
  if (report.work_mm) work_mm_ = report.work_mm;
  if (offset_mm_) {
    const auto combine = [&](const std::array<double, 3>& a, double sign) {
      return std::array<double, 3>{a[0] + sign * (*offset_mm_)[0], a[1] + sign * (*offset_mm_)[1],
                                   a[2] + sign * (*offset_mm_)[2]};
    };
    if (report.machine_mm) work_mm_ = combine(*machine_mm_, -1);
    else if (report.work_mm) machine_mm_ = combine(*work_mm_, 1);
  }
  if (report.feed_mm_per_min) feed_mm_per_min_ = *report.feed_mm_per_min;
  if (report.power) power_ = *report.power;
  if (report.overrides) overrides_ = *report.overrides;
  if (phase_ == MachinePhase::alarm && !alarm_) alarm_ = 0;
  if (phase_ != MachinePhase::idle) idle_since_s_ = -1;
  else if (idle_since_s_ < 0) idle_since_s_ = now_s;
  if (phase_ == MachinePhase::idle || phase_ == MachinePhase::running || phase_ == MachinePhase::jogging)
    alarm_.reset();
  if (stopping_ == Stopping::holding && phase_ != MachinePhase::pausing && phase_ != MachinePhase::running &&
      phase_ != MachinePhase::jogging)
    reset(now_s);  // at rest: from here a reset loses no steps
  if (phase_ == MachinePhase::paused || phase_ == MachinePhase::idle)
    pause_asked_ = pause_asked_ && phase_ == MachinePhase::paused;
  if (!job_active() || stopping_ != Stopping::no || phase_ != MachinePhase::idle || !stream_.empty() ||
      !by_hand_.empty())
    return;
  // This report may have been on its way while the last answer was: only what was asked for later counts.
  if (next_line_ >= program_.line_count() && now_s - answered_s_ > 1.5 * asking_s) end_job("done", now_s);
}

void GrblDriver::stop(const char* how, double now_s) {
  end_job(how, now_s);
  by_hand_.clear();
  after_banner_.clear();
  drop_output();
  lose_position();
  focus_until_s_.reset();
  if (stopping_ != Stopping::no) return;
  stopping_ = Stopping::holding;
  stopping_s_ = now_s;
  send_now(feed_hold);
  // A hold turns the beam off in laser mode only; homing hears nothing but a reset.
  const bool beam_stays = options_.tool == MachineTool::laser && setting(32, 1) == 0;
  if (homing_ || beam_stays || connection_ != MachineConnection::ready) reset(now_s);
}

void GrblDriver::reset(double now_s) {
  stopping_ = Stopping::resetting;
  stopping_s_ = now_s;
  stream_.clear();
  send_now(soft_reset);
}

void GrblDriver::queue(const std::string& line) { by_hand_.push_back(line); }

void GrblDriver::send(GrblStream::Line line, double now_s) {
  say("sent", line.text, now_s);
  write(line.text + "\n");
  if (line.text == "$H") homing_ = true, phase_ = MachinePhase::homing, lose_position();
  if (line.text.starts_with("$J") && phase_ != MachinePhase::jogging)
    phase_ = MachinePhase::jogging, asked_s_ = now_s;  // before a report tells it
  if (stream_.empty()) progress_s_ = now_s;
  stream_.sent(std::move(line));
}

void GrblDriver::pump(double now_s) {
  if (connection_ == MachineConnection::closed || stopping_ != Stopping::no || limits_hit_) return;
  while (!by_hand_.empty()) {
    const std::string& line = by_hand_.front();
    const bool alone = writes_eeprom(line);
    if (phase_ == MachinePhase::jogging && !line.starts_with("$J"))
      return;  // G-code is locked out until the jog has ended
    if (!stream_.has_room(line.size(), alone)) return;
    send({line, -1, alone, line == "$H" ? homing_s : dwell_s(line)}, now_s);
    by_hand_.pop_front();
  }
  if (!job_active() || pause_asked_ || phase_ == MachinePhase::paused || phase_ == MachinePhase::pausing ||
      phase_ == MachinePhase::door)
    return;
  while (next_line_ < program_.line_count()) {
    const std::string line(program_.line(next_line_));
    const bool alone = writes_eeprom(line);
    if (!stream_.has_room(line.size(), alone)) return;
    send({line, next_line_++, alone, dwell_s(line)}, now_s);
    job_->sent = next_line_;
  }
}

void GrblDriver::tick(double now_s) {
  if (connection_ == MachineConnection::closed) return;
  const bool booting = connection_ == MachineConnection::greeting && firmware_.empty() && now_s - opened_s_ < boot_s;
  const bool rests = phase_ == MachinePhase::idle && !job_active() && stream_.empty();
  if (!booting && now_s - asked_s_ >= (rests ? asking_idle_s : asking_s)) {
    send_now(ask_report);
    asked_s_ = now_s;
  }
  if (stopping_ == Stopping::holding && now_s - stopping_s_ > hold_before_reset_s) reset(now_s);
  if (stopping_ == Stopping::resetting && now_s - stopping_s_ > reset_s) {
    stopping_ = Stopping::no;
    note("The machine did not answer the reset. If it still moves, switch it off.", now_s);
  }
  if (focus_until_s_ && now_s > *focus_until_s_) focus_off();
  const double patience = connection_ == MachineConnection::greeting ? greeting_s : homing_ ? homing_s : silence_s;
  if (connection_ != MachineConnection::silent && now_s - heard_s_ > patience) {
    connection_ = MachineConnection::silent;
    homing_ = false;
    note(
        firmware_.empty()
            ? "Nothing answers: check that the machine is on, the controller chosen, and the line speed (115200 for most)."
            : "The machine does not answer any more: check the cable. If it moves, switch it off.",
        now_s);
    if (job_active()) stop("cut_off", now_s);
  }
  // At rest with lines unanswered: an answer, or a line, was lost. Waiting longer would wait for ever.
  const double since = std::max(progress_s_, idle_since_s_);
  if (!stream_.empty() && phase_ == MachinePhase::idle && idle_since_s_ >= 0 && !homing_ &&
      now_s - since > lost_answer_s + stream_.patience_s()) {
    note("The machine rests, but did not answer what was sent: something was lost on the line. Check the cable.",
         now_s);
    if (job_active()) stop("failed", now_s);
    else stream_.clear(), identifying_ = 0, connection_ = MachineConnection::ready;
  }
  pump(now_s);
}

std::unique_ptr<PreparedJob> GrblDriver::prepare(ByteView job) const {
  return machines_detail::prepared(GcodeProgram::read(job, longest_line));
}

void GrblDriver::load_prepared(const std::string& name, PreparedJob& job) {
  if (job_active()) machines_detail::refuse("job", "A job is running: stop it before another is loaded.");
  GcodeProgram& program = machines_detail::program_in<GcodeProgram>(job);
  require_fixed_origin(program);
  std::swap(program_, program);
  program_name_ = name;
  job_.reset();
}

double GrblDriver::setting(int number, double fallback) const {
  const auto found = settings_.find(number);
  return found == settings_.end() ? fallback : found->second;
}

Json GrblDriver::state(double now_s) const {
  const auto place = [&](const std::optional<std::array<double, 3>>& p) { return p ? Json(*p) : Json(nullptr); };
  const MachinePhase shown = stopping_ != Stopping::no                         ? MachinePhase::stopping
                             : pause_asked_ && phase_ == MachinePhase::running ? MachinePhase::pausing
                                                                               : phase_;
  Json state = common_state("grbl", connection_, shown, {position_known_, position_known_, position_known_}, now_s);
  state["firmware"] = firmware_;
  state["machine_mm"] = place(machine_mm_);
  state["work_mm"] = place(work_mm_);
  state["speed_mm_per_s"] = feed_mm_per_min_ / 60;
  state["power_percent"] = setting(30, 1000) > 0 ? 100 * power_ / setting(30, 1000) : 0;
  if (job_) state["job"]["careful_line"] = careful_line();
  if (alarm_) {
    const GrblWords words = grbl_alarm(*alarm_);
    state["alarm"] = {{"code", *alarm_}, {"text", words.text}, {"mend", words.mend}};
  }
  if (refused_)
    state["error"] = {{"code", refused_->code},
                      {"text", grbl_error(refused_->code)},
                      {"line", refused_->line},
                      {"line_number", refused_->line_number}};
  if (connection_ == MachineConnection::ready)
    state["laser_on"] = focus_until_s_.has_value() || (phase_ == MachinePhase::running && power_ > 0);
  state["can"] = possible_commands();
  return state;
}

}  // namespace formwright
