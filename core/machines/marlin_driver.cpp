// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/marlin_driver.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace formwright {
namespace {

constexpr std::size_t longest_line = 80, kept_lines = 200;  // MAX_CMD_SIZE 96 has number and checksum in it
constexpr double boot_s = 3, greeting_s = 15, silence_s = 25, silence_in_job_s = 120, silence_while_settling_s = 600;
constexpr double asking_s = 2, escalation_s = 2, lost_answer_s = 10, idle_s = 1;
constexpr double quiet_s = 1.5;  // an M410 may take a second to be answered
constexpr int most_resends = 100, most_unanswered = 3;

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

bool has_any(std::string text, std::initializer_list<const char*> words) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return std::any_of(words.begin(), words.end(),
                     [&](const char* word) { return text.find(word) != std::string::npos; });
}

/// "Marlin 2.1.2" of "FIRMWARE_NAME:Marlin 2.1.2 (Jan 1 2024) SOURCE_CODE_URL:..."; empty where there is none.
std::string firmware_name(const std::string& line) {
  const std::string field = "FIRMWARE_NAME:";
  const std::size_t start = line.find(field);
  if (start == std::string::npos) return "";
  std::string name = line.substr(start + field.size());
  if (const std::size_t next = name.find(':'); next != std::string::npos)
    name.resize(std::min(name.rfind(' ', next), name.size()));
  return name.substr(0, name.find(" ("));
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
  waiting_ = paused_ = position_known_ = false;
  settling_ = Settles::nothing;
  settling_number_.reset();
  forget_half_lines();
  focus_until_s_.reset();
  jogging_until_s_.reset();
  unnumbered_ = 0;
  stopped_s_ = -1;
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
  next_number_ = 0;
  oks_to_swallow_ = 0;
  send({"M110 N0"}, -1, now_s);
}

void MarlinDriver::greet(double now_s) {
  greeted_ = true;
  by_hand_.clear();
  unnumbered_ = 0;
  stopped_s_ = -1;  // what has just begun has nothing on, and may be slow to answer: no emergency
  settling_ = Settles::nothing;
  settling_number_.reset();
  start_numbering(now_s);
  for (const char* line : {"M115", "M105", "M114"}) queue(line);
}

void MarlinDriver::hear(const std::string& line, double now_s) {
  heard_s_ = now_s;
  if (connection_ == MachineConnection::silent) {
    connection_ = greeted_ ? MachineConnection::ready : MachineConnection::greeting;
    note("The machine answers again.", now_s);
  }
  if (line == "wait") return hear_idle(now_s);
  if (line.starts_with("echo:busy") || line.starts_with("busy:")) return;
  say("received", line, now_s);
  if (line == "start" || line.starts_with("Marlin ")) {
    if (job_active()) {
      end("failed", now_s);
      note("The machine restarted by itself in the middle of the job: check its power supply and cable.", now_s);
    }
    position_known_ = halted_ = false;
    if (line == "start" || !greeted_) greet(now_s);
  } else if (line.starts_with("ok")) hear_ok(line, now_s);
  else if (line.starts_with("Resend:") || line.starts_with("rs "))
    hear_resend(std::atoi(line.c_str() + line.find_first_of(": ") + 1), now_s);
  else if (line.starts_with("Error:") || line.starts_with("fatal:"))
    hear_error(std::string_view(line).substr(6), now_s);
  else if (line.starts_with("!!")) hear_error(std::string_view(line).substr(2), now_s);
  else {
    if (const std::string name = firmware_name(line); !name.empty()) firmware_ = name;
    if (has_any(line, {"unknown command"})) refused_ = line;
    hear_report(line, now_s);
  }
}

void MarlinDriver::hear_error(std::string_view text, double now_s) {
  const std::string what(text.substr(std::min(text.find_first_not_of(' '), text.size())));
  // What is wrong with a line's number or sum: a request follows, or nothing at all.
  if (has_any(what, {"checksum", "line number", "expected line"})) return;
  if (has_any(what, {"unknown command"})) refused_ = what;
  else halt(what, now_s);
}

void MarlinDriver::hear_report(const std::string& line, double now_s) {
  const auto x = number_after(line, "X:"), y = number_after(line, "Y:"), z = number_after(line, "Z:");
  if (!x || !y || !z) {
    for (const auto& [name, key] : {std::pair{"T:", "hotend_c"}, std::pair{"B:", "bed_c"}})
      if (const auto value = number_after(line, name)) temperatures_[key] = *value;
    return;
  }
  position_mm_ = {*x, *y, *z};  // motors may be called A, B, C behind it
  if (settling_number_) settled(now_s);
}

void MarlinDriver::settled(double now_s) {
  if (settling_ == Settles::homing) position_known_ = true;
  if (settling_ == Settles::job) end("done", now_s);
  settling_ = Settles::nothing;
  settling_number_.reset();
}

void MarlinDriver::hear_ok(const std::string& line, double now_s) {
  unanswered_in_a_row_ = 0;
  hear_report(line, now_s);
  if (oks_to_swallow_ > 0) {
    --oks_to_swallow_;
    return;  // sending starts with this
  }
  if (unnumbered_ > 0) unnumbered_s_ = now_s;
  if (!waiting_) {
    unnumbered_ = std::max(unnumbered_ - 1, 0);
    return;
  }
  waiting_ = false;
  resends_ = 0;
  if (connection_ == MachineConnection::greeting && by_hand_.empty()) connection_ = MachineConnection::ready;
  if (sent_.empty() || resend_at_ == 0) return;
  const SentLine& answered = sent_[resend_at_ - 1];
  // A machine that never tells its place has no other answer.
  if (settling_number_ && answered.number >= *settling_number_ && !position_mm_) settled(now_s);
  if (answered.job_line >= 0 && job_active()) {
    if (answered.text.starts_with("G28")) position_known_ = true;
    job_->acknowledged = std::max(job_->acknowledged, answered.job_line + 1);
    job_->line_now = program_.number(job_->acknowledged - 1);
  }
}

void MarlinDriver::hear_resend(int number, double now_s) {
  if (halted_) return;
  if (++resends_ > most_resends) {
    // Lines with numbers do not get through.
    end("failed", now_s);
    turn_all_off_at_once(now_s);
    return halt("it asks for the same lines over and over. Check cable and line speed.", now_s);
  }
  const auto found =
      std::find_if(sent_.begin(), sent_.end(), [&](const SentLine& line) { return line.number == number; });
  if (found == sent_.end() && number != next_number_) {
    note("The machine asks for a line that it has had long ago: it may have restarted.", now_s);
    stop("failed", now_s);
    start_numbering(now_s);
    oks_to_swallow_ = 1;
    return;
  }
  resend_at_ = static_cast<std::size_t>(found - sent_.begin());
  waiting_ = false;
  oks_to_swallow_ = 1;  // every request is followed by an ok of its own
}

void MarlinDriver::hear_idle(double now_s) {
  // Said by a machine that has nothing to do: what was sent a while ago never came, or its answer did not.
  if ((waiting_ || oks_to_swallow_ > 0) && now_s - sent_s_ > idle_s) go_on_unanswered(now_s);
}

void MarlinDriver::go_on_unanswered(double now_s) {
  note("A line was not answered: going on, so that the machine asks for what it lacks.", now_s);
  waiting_ = false;
  oks_to_swallow_ = 0;
  ++unanswered_in_a_row_;
  sent_s_ = now_s;
}

void MarlinDriver::halt(const std::string& text, double now_s) {
  if (!halted_) halt_text_ = text;  // the first sentence tells the cause
  halted_ = true;
  position_known_ = false;
  by_hand_.clear();
  settling_ = Settles::nothing;
  settling_number_.reset();
  stopped_s_ = -1;
  end("failed", now_s);
}

void MarlinDriver::send(const HandLine& line, int job_line, double now_s) {
  say("sent", line.text, now_s);
  const int number = next_number_++;
  write(numbered_line(number, line.text) + "\n");
  sent_.push_back({number, job_line, line.text});
  if (sent_.size() > kept_lines) sent_.pop_front();
  resend_at_ = sent_.size();
  waiting_ = true;
  sent_s_ = now_s;
  if (line.settles != Settles::nothing) settling_number_ = number;
  if (line.text.starts_with("G28")) position_known_ = false;
}

void MarlinDriver::pump(double now_s) {
  if (connection_ == MachineConnection::closed || connection_ == MachineConnection::silent || waiting_ || halted_ ||
      !greeted_ || oks_to_swallow_ > 0 || unnumbered_ > 0)
    return;
  if (resend_at_ < sent_.size()) {
    const SentLine& again = sent_[resend_at_++];
    say("sent", again.text, now_s);
    write(numbered_line(again.number, again.text) + "\n");
    waiting_ = true;
    sent_s_ = now_s;
    return;
  }
  if (by_hand_.empty() && job_active() && !paused_ && settling_ == Settles::nothing &&
      next_line_ >= program_.line_count())
    settle(Settles::job);
  if (!by_hand_.empty()) {
    const HandLine line = by_hand_.front();
    by_hand_.pop_front();
    return send(line, -1, now_s);
  }
  if (!job_active() || paused_ || next_line_ >= program_.line_count()) return;
  send({std::string(program_.line(next_line_))}, next_line_, now_s);
  job_->sent = ++next_line_;
}

void MarlinDriver::settle(Settles what) {
  settling_ = what;
  settling_number_.reset();
  if (what != Settles::homing) queue("M400");  // answered when all moves are done
  queue("M114", what);
}

void MarlinDriver::tick(double now_s) {
  if (connection_ == MachineConnection::closed) return;
  if (!greeted_ && now_s - opened_s_ > boot_s) greet(now_s);
  if (jogging_until_s_ && now_s > *jogging_until_s_) {
    jogging_until_s_.reset();
    ask_soon();
  }
  if (greeted_ && by_hand_.empty() && !halted_ && now_s - asked_s_ > asking_s) {
    asked_s_ = now_s;
    queue("M105");
    if (!job_active() || settling_number_) queue("M114");
  }
  if (focus_until_s_ && now_s > *focus_until_s_) focus_off(now_s);
  watch_over_stop(now_s);
  if ((waiting_ || oks_to_swallow_ > 0) && connection_ == MachineConnection::ready &&
      unanswered_in_a_row_ < most_unanswered && now_s - std::max(heard_s_, sent_s_) > lost_answer_s)
    go_on_unanswered(now_s);
  const double patience = connection_ == MachineConnection::greeting ? greeting_s
                          : settling_ != Settles::nothing            ? silence_while_settling_s
                          : job_active()                             ? silence_in_job_s
                                                                     : silence_s;
  if (connection_ != MachineConnection::silent && now_s - heard_s_ > patience) {
    connection_ = MachineConnection::silent;
    waiting_ = false;
    note("Nothing answers: check that the machine is on, the controller chosen, and the line speed (115200 or 250000).",
         now_s);
    if (job_active()) stop("cut_off", now_s);
    settling_ = Settles::nothing;
    settling_number_.reset();
  }
  pump(now_s);
}

void MarlinDriver::watch_over_stop(double now_s) {
  if (unnumbered_ > 0 && !waiting_ && now_s - unnumbered_s_ > quiet_s) unnumbered_ = 0;  // these were not answered
  if (stopped_s_ < 0) return;
  // Where nothing can be sent now, nothing is waited for.
  const bool sends = greeted_ && !halted_ && connection_ != MachineConnection::silent;
  if (!waiting_ && unnumbered_ == 0 && (by_hand_.empty() || !sends)) stopped_s_ = -1;
  else if (waiting_ && now_s - std::max(stopped_s_, sent_s_) > escalation_s) {
    // M410 was not heard: boards without an emergency parser take it in turn only. M112 ends everything.
    write_urgently("M112\n");
    halt("it did not stop when asked, so it was sent M112.", now_s);
  }
}

std::unique_ptr<PreparedJob> MarlinDriver::prepare(ByteView job) const {
  return machines_detail::prepared(GcodeProgram::read(job, longest_line));
}

void MarlinDriver::load_prepared(const std::string& name, PreparedJob& job) {
  if (job_active()) machines_detail::refuse("job", "A job is running: stop it before another is loaded.");
  GcodeProgram& program = machines_detail::program_in<GcodeProgram>(job);
  if (options_.tool != MachineTool::printer) require_fixed_origin(program);  // a printer's jobs home it themselves
  std::swap(program_, program);
  program_name_ = name;
  job_.reset();
}

void MarlinDriver::end(const char* how, double now_s) {
  if (end_job(how, now_s)) paused_ = false;
}

std::vector<std::string> MarlinDriver::lines_that_turn_off() const {
  std::vector<std::string> lines;
  if (options_.tool != MachineTool::printer) lines.push_back("M5");
  // Lasers and mills on a printer's board may have heaters, too.
  if (options_.tool == MachineTool::printer || !temperatures_.empty())
    lines.insert(lines.end(), {"M104 S0", "M140 S0", "M107"});
  return lines;
}

void MarlinDriver::write_unnumbered(const std::string& line, double now_s) {
  write_urgently(line + "\n");
  ++unnumbered_;
  unnumbered_s_ = now_s;
}

void MarlinDriver::turn_all_off_at_once(double now_s) {
  // The first two need no turn where the firmware has an emergency parser.
  for (const char* line : {"M108", "M410"}) write_unnumbered(line, now_s);
  for (const std::string& line : lines_that_turn_off()) write_unnumbered(line, now_s);
}

void MarlinDriver::focus_off(double now_s) {
  focus_until_s_.reset();
  // A light that is not on yet never comes on.
  std::erase_if(by_hand_, [](const HandLine& line) { return line.text.starts_with("M3 "); });
  write_unnumbered("M5", now_s);
  queue("M5");
}

void MarlinDriver::stop(const char* how, double now_s) {
  end(how, now_s);
  by_hand_.clear();
  drop_output();
  // A line that did not leave or did not arrive will be asked for by its number: it must not move anything then.
  for (SentLine& line : sent_)
    if (!line.text.starts_with("M110")) line = {line.number, -1, "M105"};
  resend_at_ = sent_.size();
  position_known_ = false;
  settling_ = Settles::nothing;
  settling_number_.reset();
  focus_until_s_.reset();
  jogging_until_s_.reset();
  oks_to_swallow_ = 0;
  turn_all_off_at_once(now_s);
  for (const std::string& line : lines_that_turn_off()) queue(line);
  stopped_s_ = now_s;
}

}  // namespace formwright
