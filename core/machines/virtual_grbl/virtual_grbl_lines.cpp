// SPDX-License-Identifier: GPL-3.0-or-later
// How the virtual GRBL takes lines out of its buffer: one after the other, each answered when all it asked for is done
// or in the planner (protocol.c protocol_main_loop).
#include "machines/virtual_grbl/virtual_grbl.h"

namespace formwright {

void VirtualGrbl::answer(int error) { output_ += error == 0 ? "ok\r\n" : "error:" + std::to_string(error) + "\r\n"; }

void VirtualGrbl::read_line() {
  const std::size_t end = rx_.find('\n');
  std::string line;
  char comment = '\0';  // what it began with: '(' ends with ')', ';' with the line (protocol.c)
  for (const char c : rx_.substr(0, end))
    if (comment != '\0') comment = comment == '(' && c == ')' ? '\0' : comment;
    else if (c == '(' || c == ';') comment = c;
    else if (c > ' ' && c != '/') line += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  rx_.erase(0, end + 1);
  lines_.push_back(line);
  in_line_ = true;
  if (line.size() > 79) return finish_line(11);
  if (refuse_next_ != 0 && !line.empty()) return finish_line(std::exchange(refuse_next_, 0));
  if (refused_line_.second != 0 && line == refused_line_.first) return finish_line(refused_line_.second);
  const long epoch = epoch_;
  const int error = line.empty() ? 0 : act(line);
  if (epoch != epoch_) return;  // an alarm or a reset: nobody waits for the answer
  if (error != 0) {
    steps_.clear();
    finish_line(error);
  }
}

void VirtualGrbl::finish_line(int error) {
  last_error_ = error;
  if (startup_now_.empty()) {
    answer(error);
  } else {
    output_ += ">" + startup_now_ + ":";  // report.c report_execute_startup_message
    answer(error);
    startup_now_.clear();
  }
  in_line_ = keeps_printable_ = false;
}

int VirtualGrbl::act(const std::string& line) {
  if (line.starts_with("$J=")) {
    if (state_ != "Idle" && state_ != "Jog") return 8;
    return act_on_gcode(line.substr(3), true);
  }
  if (line[0] == '$') return act_on_system_line(line);
  if (state_ == "Alarm" || state_ == "Jog") return 9;
  if (options_.error_latch && last_error_ != 0) return last_error_;
  return act_on_gcode(line, false);
}

void VirtualGrbl::run_steps() {
  for (;;) {
    while (!steps_.empty()) {
      const Step step = steps_.front();
      const long epoch = epoch_;
      const bool done = step();
      if (epoch != epoch_) return;
      if (!done) return;
      steps_.pop_front();
    }
    if (in_line_) finish_line(0);
    if (startup_left_.empty() || state_ == "Alarm") return;
    startup_now_ = startup_left_.front();
    startup_left_.pop_front();
    in_line_ = true;
    const long epoch = epoch_;
    const int error = act_on_gcode(startup_now_, false);
    if (epoch != epoch_) return;
    if (error != 0) steps_.clear(), finish_line(error);
  }
}

void VirtualGrbl::run_startup_lines() {
  startup_now_.clear();
  for (const std::string& line : startup_)
    if (!line.empty()) startup_left_.push_back(line);
}

/// protocol.c protocol_buffer_synchronize.
void VirtualGrbl::then_wait_for_rest() {
  then([this] { return at_rest(); });
}

/// Nothing is heard meanwhile; the answer comes when it is written.
void VirtualGrbl::then_write_eeprom() {
  then_wait_for_rest();
  then([this] {
    deaf_until_s_ = time_s_ + options_.eeprom_s;
    return true;
  });
  then([this] { return time_s_ >= deaf_until_s_; });
}

/// spindle_control.c spindle_sync: whatever changes the spindle waits for the planner to be empty.
void VirtualGrbl::then_spindle(int state, double power) {
  if (state_ == "Check") return;
  then_wait_for_rest();
  then([this, state, power] {
    set_spindle(state, power);
    return true;
  });
}

}  // namespace formwright
