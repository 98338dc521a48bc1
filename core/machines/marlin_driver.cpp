// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/marlin_driver.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace formwright {
namespace {

constexpr std::size_t longest_line = 80, kept_lines = 200;  // MAX_CMD_SIZE 96 has number and checksum in it
constexpr double boot_s = 3, greeting_s = 15, silence_s = 25, asking_s = 2, escalation_s = 2, lost_answer_s = 10;
constexpr int most_resends = 100;

/// The number behind `name` ("X:", "T:"), if it is there.
std::optional<double> number_after(const std::string& line, const std::string& name) {
  for (std::size_t at = line.find(name); at != std::string::npos; at = line.find(name, at + 1)) {
    if (at > 0 && line[at - 1] != ' ') continue;
    const char* start = line.c_str() + at + name.size();
    char* end = nullptr;
    const double value = std::strtod(start, &end);
    if (end != start && std::isfinite(value)) return value;
  }
  return std::nullopt;
}

}  // namespace

std::string numbered_line(int number, std::string_view line) {
  std::string text = "N" + std::to_string(number) + " " + std::string(line);
  unsigned checksum = 0;
  for (const char c : text) checksum ^= static_cast<unsigned char>(c);
  return text + "*" + std::to_string(checksum & 0xffu);
}

void MarlinDriver::opened(double now_s) {
  *this = MarlinDriver(options_);
  connection_ = MachineConnection::greeting;
  opened_s_ = heard_s_ = asked_s_ = now_s;
}

void MarlinDriver::closed(double now_s) {
  if (connection_ == MachineConnection::closed) return;
  if (job_active()) {
    end("cut_off", now_s);
    note("The machine is gone in the middle of the job. Its heaters or laser may still be on: look after it.", now_s);
  }
  drop_output();
  by_hand_.clear();
  sent_.clear();
  resend_at_ = 0;
  waiting_ = paused_ = position_known_ = homing_ = draining_ = false;
  forget_half_lines();
  focus_until_s_.reset();
  connection_ = MachineConnection::closed;
  position_mm_.reset();
}

void MarlinDriver::received(ByteView bytes, double now_s) {
  if (connection_ == MachineConnection::closed) return;
  for (const std::string& line : lines_in(bytes)) hear(line, now_s);
  pump(now_s);
}

void MarlinDriver::start_numbering(double now_s) {
  sent_.clear();
  resend_at_ = 0;
  next_number_ = 0;
  oks_to_swallow_ = 0;
  waiting_ = false;
  greeted_ = true;
  by_hand_.clear();
  send("M110 N0", -1, now_s);
  for (const char* line : {"M115", "M105", "M114"}) queue(line);
}

void MarlinDriver::hear(const std::string& line, double now_s) {
  heard_s_ = now_s;
  if (connection_ == MachineConnection::silent) {
    connection_ = greeted_ ? MachineConnection::ready : MachineConnection::greeting;
    note("The machine answers again.", now_s);
  }
  if (!line.starts_with("echo:busy")) say("received", line, now_s);
  if (line == "start" || line.starts_with("Marlin ")) {
    if (job_active()) {
      end("failed", now_s);
      note("The machine restarted by itself in the middle of the job: check its power supply and cable.", now_s);
    }
    position_known_ = halted_ = false;
    if (line == "start" || !greeted_) start_numbering(now_s);
  } else if (line.starts_with("ok")) hear_ok(line, now_s);
  else if (line.starts_with("Resend:") || line.starts_with("rs ")) hear_resend(std::atoi(line.c_str() + line.find_first_of(": ") + 1), now_s);
  else if (line.starts_with("Error:") || line.starts_with("!!")) {
    const bool about_the_line = line.find("checksum") != std::string::npos || line.find("Line Number") != std::string::npos;
    if (!about_the_line) halt(line.substr(line.starts_with("!!") ? 2 : 6), now_s);
  } else {
    if (line.find("FIRMWARE_NAME:") != std::string::npos) {
      const std::size_t from = line.find("FIRMWARE_NAME:") + 14;
      firmware_ = line.substr(from, std::min(line.find(" (", from), line.find(" SOURCE", from)) - from);
    }
    if (line.find("Unknown command") != std::string::npos) refused_ = line;
    hear_temperatures(line);
    if (const auto x = number_after(line, "X:"), y = number_after(line, "Y:"), z = number_after(line, "Z:"); x && y && z) position_mm_ = {*x, *y, *z};
  }
}

void MarlinDriver::hear_temperatures(const std::string& line) {
  for (const auto& [name, key] : {std::pair{"T:", "hotend_c"}, std::pair{"B:", "bed_c"}})
    if (const auto value = number_after(line, name)) temperatures_[key] = *value;
}

void MarlinDriver::hear_ok(const std::string& line, double now_s) {
  hear_temperatures(line);
  if (oks_to_swallow_ > 0) {
    --oks_to_swallow_;
    return;  // sending starts with this
  }
  if (!waiting_) return;
  waiting_ = false;
  resends_ = 0;
  if (connection_ == MachineConnection::greeting && by_hand_.empty()) connection_ = MachineConnection::ready;
  if (sent_.empty() || resend_at_ == 0) return;
  const SentLine& answered = sent_[resend_at_ - 1];
  if (answered.text == "G28") homing_ = false, position_known_ = true;
  if (answered.text == "M400" && draining_ && job_active() && next_line_ >= program_.line_count()) {
    draining_ = false;
    end("done", now_s);
  }
  if (answered.job_line >= 0 && job_active()) {
    job_->acknowledged = std::max(job_->acknowledged, answered.job_line + 1);
    job_->line_now = program_.number(job_->acknowledged - 1);
  }
}

void MarlinDriver::hear_resend(int number, double now_s) {
  const auto found = std::find_if(sent_.begin(), sent_.end(), [&](const SentLine& line) { return line.number == number; });
  if (found == sent_.end() || ++resends_ > most_resends) {
    note(resends_ > most_resends ? "The machine asks for the same lines over and over: the line is too noisy. Check cable and line speed."
                                 : "The machine asks for a line that it has had long ago: it may have restarted.",
         now_s);
    stop("failed", now_s);
    return;
  }
  resend_at_ = static_cast<std::size_t>(found - sent_.begin());
  waiting_ = false;
  oks_to_swallow_ = 1;  // every request is followed by an ok of its own
}

void MarlinDriver::halt(const std::string& text, double now_s) {
  halted_ = true;
  halt_text_ = text;
  position_known_ = false;
  by_hand_.clear();
  end("failed", now_s);
}

void MarlinDriver::send(const std::string& text, int job_line, double now_s) {
  say("sent", text, now_s);
  const int number = next_number_++;
  write(numbered_line(number, text) + "\n");
  sent_.push_back({number, job_line, text});
  if (sent_.size() > kept_lines) sent_.pop_front();
  resend_at_ = sent_.size();
  waiting_ = true;
  if (text == "G28") homing_ = true, position_known_ = false;
}

void MarlinDriver::pump(double now_s) {
  if (connection_ == MachineConnection::closed || connection_ == MachineConnection::silent || waiting_ || halted_ || !greeted_ || oks_to_swallow_ > 0) return;
  if (resend_at_ < sent_.size()) {
    const SentLine& again = sent_[resend_at_++];
    say("sent", again.text, now_s);
    write(numbered_line(again.number, again.text) + "\n");
    waiting_ = true;
    return;
  }
  if (!by_hand_.empty()) {
    const std::string line = by_hand_.front();
    by_hand_.pop_front();
    return send(line, -1, now_s);
  }
  if (!job_active() || paused_) return;
  if (next_line_ < program_.line_count()) {
    send(std::string(program_.line(next_line_)), next_line_, now_s);
    job_->sent = ++next_line_;
  } else if (!draining_) {
    draining_ = true;
    send("M400", -1, now_s);  // answered when all moves are done
  }
}

void MarlinDriver::tick(double now_s) {
  if (connection_ == MachineConnection::closed) return;
  if (!greeted_ && now_s - opened_s_ > boot_s) start_numbering(now_s);
  if (greeted_ && by_hand_.empty() && !halted_ && now_s - asked_s_ > asking_s) {
    asked_s_ = now_s;
    queue("M105");
    if (!job_active()) queue("M114");
  }
  if (focus_until_s_ && now_s > *focus_until_s_) {
    focus_until_s_.reset();
    queue("M5");
  }
  if (stopped_s_ >= 0 && (!waiting_ || now_s - stopped_s_ > escalation_s)) {
    // M410 was not heard: boards without an emergency parser take it in turn only. M112 ends everything.
    if (waiting_) write_urgently("M112\n"), note("The machine did not stop when asked: it was halted (M112) and needs a reset.", now_s);
    stopped_s_ = -1;
  }
  // A lost answer, or a lost line: the next number tells the machine which, and it asks for what it lacks.
  if ((waiting_ || oks_to_swallow_ > 0) && !homing_ && !draining_ && connection_ == MachineConnection::ready && now_s - heard_s_ > lost_answer_s) {
    waiting_ = false;
    oks_to_swallow_ = 0;
    heard_s_ = now_s;
    note("An answer was lost on the line: going on with the next line.", now_s);
  }
  const double patience = connection_ == MachineConnection::greeting ? greeting_s : homing_ || draining_ ? 600 : job_active() ? 120 : silence_s;
  if (connection_ != MachineConnection::silent && now_s - heard_s_ > patience) {
    connection_ = MachineConnection::silent;
    waiting_ = homing_ = false;
    note("Nothing answers: check that the machine is on, the controller chosen, and the line speed (115200 or 250000).", now_s);
    if (job_active()) stop("cut_off", now_s);
  }
  pump(now_s);
}

void MarlinDriver::load(const std::string& name, ByteView job) {
  if (job_active()) machines_detail::refuse("job", "A job is running: stop it before another is loaded.");
  program_ = GcodeProgram::read(job, longest_line);
  program_name_ = name;
  job_.reset();
}

void MarlinDriver::end(const char* how, double now_s) {
  if (end_job(how, now_s)) paused_ = draining_ = false;
}

void MarlinDriver::stop(const char* how, double now_s) {
  end(how, now_s);
  by_hand_.clear();
  drop_output();
  // A line that did not leave will be asked for by its number: it must not move anything then.
  for (SentLine& line : sent_)
    if (line.job_line >= 0) line.text = "M105", line.job_line = -1;
  resend_at_ = sent_.size();
  position_known_ = homing_ = false;
  focus_until_s_.reset();
  // The first two need no turn where the firmware has an emergency parser; the others follow in any case.
  write_urgently("M108\n");
  write_urgently("M410\n");
  oks_to_swallow_ = 0;
  for (const char* line : {"M5", "M104 S0", "M140 S0", "M107"}) {
    if (options_.tool != MachineTool::printer && line[1] == '1') continue;
    if (options_.tool == MachineTool::printer && line[1] == '5') continue;
    queue(line);
  }
  stopped_s_ = now_s;
}

}  // namespace formwright
