// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/marlin/marlin_driver.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace formwright {
namespace {

constexpr std::size_t longest_line = 80, kept_lines = 200;  // MAX_CMD_SIZE 96 has number and checksum in it
constexpr double flush_s = 0.1, boot_s = 3, greeting_s = 15, marlin_silence_s = 25, silence_in_job_s = 120,
                 silence_while_settling_s = 600;
constexpr double marlin_asking_s = 2, lost_answer_s = 10, idle_s = 1;
constexpr int max_resends = 100, max_unanswered = 3;

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
  // A board that does not restart may shine since somebody else went, perhaps in the middle of a line: that one is
  // ended first, because the machine throws away what lies behind a bad one (flush_and_request_resend()).
  if (options_.tool == MachineTool::laser) write("\n");
}

void MarlinDriver::closed(double now_s) {
  if (connection_ == MachineConnection::closed) return;
  if (job_active()) {
    end("cut_off", now_s);
    note(
        "The connection to the machine was lost during the job. Its heaters or laser may still be on: go to the machine.",
        now_s);
  }
  drop_output();
  by_hand_.clear();
  sent_.clear();
  resend_at_ = 0;
  waiting_ = 0;
  paused_ = dark_ = false;
  settling_ = Settles::nothing;
  settling_number_.reset();
  forget_half_lines();
  focus_until_s_.reset();
  jogging_until_s_.reset();
  unnumbered_ = 0;
  stopped_s_ = -1;
  connection_ = MachineConnection::closed;
  place_.forget();
  z_set_s_.reset();
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
  focus_until_s_.reset();
  jogging_until_s_.reset();
  no_m5_ = dark_ = false;
  start_numbering(now_s);
  if (options_.tool == MachineTool::laser) queue_dark();
  for (const char* line : {"M115", "M211", "M105", "M114"}) queue(line);
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
      note("The machine restarted by itself during the job: check its power supply and cable.", now_s);
    }
    place_.lose();
    halted_ = false;
    focus_until_s_.reset();  // what goes on would light it again
    if (line == "start" || !greeted_) greet(now_s);
  } else if (line.starts_with("ok")) hear_ok(line, now_s);
  else if (line.starts_with("Resend:") || line.starts_with("rs "))
    hear_resend(std::atoi(line.c_str() + line.find_first_of(": ") + 1), now_s);
  else if (line.starts_with("Error:") || line.starts_with("fatal:"))
    hear_error(std::string_view(line).substr(6), now_s);
  else if (line.starts_with("!!")) hear_error(std::string_view(line).substr(2), now_s);
  else {
    if (const std::string name = firmware_name(line); !name.empty()) firmware_ = name;
    if (has_any(line, {"unknown command"})) hear_unknown(line);
    else if (const auto limits = MarlinPlace::limits_in(line)) limits_ = limits;
    else hear_report(line, now_s);
  }
}

void MarlinDriver::hear_error(std::string_view text, double now_s) {
  const std::string what(text.substr(std::min(text.find_first_not_of(' '), text.size())));
  // What is wrong with a line's number or sum: a request follows, or nothing at all.
  if (has_any(what, {"checksum", "line number", "expected line"})) return;
  if (has_any(what, {"unknown command"})) hear_unknown(what);
  else halt(what, now_s);
}

void MarlinDriver::hear_unknown(const std::string& text) {
  if (text.find("M211") != std::string::npos) return;  // a firmware without limits: the profile's bed counts
  const std::size_t m5 = text.find("M5");
  if (m5 != std::string::npos && (m5 + 2 == text.size() || text[m5 + 2] < '0' || text[m5 + 2] > '9'))
    no_m5_ = true, dark_ = false;
  else refused_ = text;
}

void MarlinDriver::hear_report(const std::string& line, double now_s) {
  const auto x = number_after(line, "X:"), y = number_after(line, "Y:"), z = number_after(line, "Z:");
  if (!x || !y || !z) {
    for (const auto& [name, key] : {std::pair{"T:", "hotend_c"}, std::pair{"B:", "bed_c"}})
      if (const auto value = number_after(line, name)) temperatures_[key] = *value;
    return;
  }
  place_.reported({*x, *y, *z});  // motors may be called A, B, C behind it
  if (settling_number_) settled(now_s);
}

void MarlinDriver::settled(double now_s) {
  if (settling_ == Settles::homing) place_.homed();
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
  if (waiting_ == 0) {
    unnumbered_ = std::max(unnumbered_ - 1, 0);
    return;
  }
  --waiting_;
  resends_ = 0;
  if (connection_ == MachineConnection::greeting && by_hand_.empty()) connection_ = MachineConnection::ready;
  if (resend_at_ <= static_cast<std::size_t>(waiting_)) return;
  const SentLine& answered = sent_[resend_at_ - 1 - static_cast<std::size_t>(waiting_)];
  if (answered.text == "M5 I") dark_ = !no_m5_ && !laser_use_.fan;
  // A machine that never tells its place has no other answer.
  if (settling_number_ && answered.number >= *settling_number_ && !place_.position_mm()) settled(now_s);
  if (answered.job_line >= 0 && job_active()) {
    if (answered.text.starts_with("G28")) place_.homed();
    job_->acknowledged = std::max(job_->acknowledged, answered.job_line + 1);
    job_->line_now = program_.number(job_->acknowledged - 1);
  }
}

void MarlinDriver::hear_resend(int number, double now_s) {
  if (halted_ || !greeted_) return;
  if (++resends_ > max_resends) {
    // Lines with numbers do not get through.
    end("failed", now_s);
    turn_all_off_at_once(now_s);
    return halt("it asks for the same lines over and over. Check cable and line speed.", now_s);
  }
  const auto found =
      std::find_if(sent_.begin(), sent_.end(), [&](const SentLine& line) { return line.number == number; });
  if (found == sent_.end() && number != next_number_) {
    note("The machine asks for a line that it received long ago: it may have restarted.", now_s);
    stop("failed", now_s);
    start_numbering(now_s);
    oks_to_swallow_ = 1;
    return;
  }
  resend_at_ = static_cast<std::size_t>(found - sent_.begin());
  waiting_ = 0;
  oks_to_swallow_ = 1;  // every request is followed by an ok of its own
}

void MarlinDriver::hear_idle(double now_s) {
  // Said by a machine that has nothing to do: what was sent a while ago never came, or its answer did not.
  if ((waiting_ > 0 || oks_to_swallow_ > 0) && now_s - sent_s_ > idle_s) go_on_unanswered(now_s);
}

void MarlinDriver::go_on_unanswered(double now_s) {
  note("One line was not answered. Sending continues, so that the machine asks for missing lines.", now_s);
  waiting_ = 0;
  oks_to_swallow_ = 0;
  ++unanswered_in_a_row_;
  sent_s_ = now_s;
}

void MarlinDriver::halt(const std::string& text, double now_s) {
  if (!halted_) halt_text_ = text;  // the first sentence tells the cause
  halted_ = true;
  dark_ = false;
  place_.lose();
  focus_until_s_.reset();
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
  keep({number, job_line, line.text});
  waiting_ = 1;
  sent_s_ = now_s;
  if (line.settles != Settles::nothing) settling_number_ = number;
  place_.sending(line.text);
  if (line.text.starts_with("G28")) z_set_s_.reset();
  if (marlin_may_light(line.text)) dark_ = false;
}

void MarlinDriver::keep(SentLine line) {
  sent_.push_back(std::move(line));
  if (sent_.size() > kept_lines) sent_.pop_front();
  resend_at_ = sent_.size();
}

void MarlinDriver::send_again(double now_s) {
  std::string together;
  bool with_next = true;
  while (with_next && resend_at_ < sent_.size()) {
    const SentLine& again = sent_[resend_at_++];
    say("sent", again.text, now_s);
    together += numbered_line(again.number, again.text) + "\n";
    with_next = again.with_next;
    ++waiting_;
  }
  write(together);
  sent_s_ = now_s;
}

void MarlinDriver::pump(double now_s) {
  if (connection_ == MachineConnection::closed || connection_ == MachineConnection::silent || waiting_ > 0 || halted_ ||
      !greeted_ || oks_to_swallow_ > 0 || unnumbered_ > 0)
    return;
  if (resend_at_ < sent_.size()) return send_again(now_s);
  if (by_hand_.empty() && job_active() && !paused_ && settling_ == Settles::nothing &&
      next_line_ >= program_.line_count())
    settle(Settles::job);
  if (!by_hand_.empty()) {
    const HandLine line = by_hand_.front();
    by_hand_.pop_front();
    return send(line, -1, now_s);
  }
  if (focus_until_s_) return send_focus_pulse(now_s);
  if (!job_active() || paused_ || next_line_ >= program_.line_count()) return;
  const std::string line(program_.line(next_line_));
  if (options_.tool != MachineTool::laser) return send_job_line(line, now_s);
  // Such a line waits in the machine for the moves before it: a stop drops those, and it would shine where they end.
  if (marlin_power_after(line, MarlinPower::off) == MarlinPower::standard && !std::exchange(rests_, !rests_))
    return send({"M400"}, -1, now_s);
  send_job_line(marlin_line_as_sent(line), now_s);
}

void MarlinDriver::send_job_line(const std::string& line, double now_s) {
  send({line}, next_line_, now_s);
  job_->sent = ++next_line_;
}

void MarlinDriver::settle(Settles what) {
  settling_ = what;
  settling_number_.reset();
  if (what == Settles::job && has_cutter()) queue_dark();
  if (what != Settles::homing) queue("M400");  // answered when all moves are done
  queue("M114", what);
}

void MarlinDriver::tick(double now_s) {
  if (connection_ == MachineConnection::closed) return;
  if (!greeted_ && now_s - opened_s_ > flush_s && options_.tool == MachineTool::laser && !darkened_) {
    darkened_ = true;
    write("M5\n");
  }
  if (!greeted_ && now_s - opened_s_ > boot_s) greet(now_s);
  if (jogging_until_s_ && now_s > *jogging_until_s_) {
    jogging_until_s_.reset();
    ask_soon();
  }
  if (greeted_ && by_hand_.empty() && !halted_ && now_s - asked_s_ > marlin_asking_s) {
    asked_s_ = now_s;
    queue("M105");
    if (!job_active() || settling_number_) queue("M114");
  }
  if (focus_until_s_ && now_s > *focus_until_s_) focus_off(now_s);
  watch_over_stop(now_s);
  if ((waiting_ > 0 || oks_to_swallow_ > 0) && connection_ == MachineConnection::ready &&
      unanswered_in_a_row_ < max_unanswered && now_s - std::max(heard_s_, sent_s_) > lost_answer_s)
    go_on_unanswered(now_s);
  const double patience = connection_ == MachineConnection::greeting ? greeting_s
                          : settling_ != Settles::nothing            ? silence_while_settling_s
                          : job_active()                             ? silence_in_job_s
                                                                     : marlin_silence_s;
  if (connection_ != MachineConnection::silent && now_s - heard_s_ > patience) {
    connection_ = MachineConnection::silent;
    waiting_ = 0;
    dark_ = false;
    focus_until_s_.reset();
    note("Nothing answers: check that the machine is on, the controller chosen, and the line speed (115200 or 250000).",
         now_s);
    if (job_active()) stop("cut_off", now_s);
    settling_ = Settles::nothing;
    settling_number_.reset();
  }
  pump(now_s);
}

std::unique_ptr<PreparedJob> MarlinDriver::prepare(ByteView job) const {
  MarlinJob read;
  read.program = GcodeProgram::read(job, longest_line, true);
  const bool printer = options_.tool == MachineTool::printer;
  require_runnable(read.program, {printer ? GcodeDialect::marlin_printer : GcodeDialect::marlin});
  read.laser_use = marlin_laser_use(read.program);
  return machines_detail::prepared(std::move(read));
}

void MarlinDriver::load_prepared(const std::string& name, PreparedJob& job) {
  if (job_active()) machines_detail::refuse("job", "A job is running: stop it before another is loaded.");
  MarlinJob& taken = machines_detail::program_in<MarlinJob>(job);
  std::swap(program_, taken.program);
  laser_use_ = taken.laser_use;
  program_name_ = name;
  job_.reset();
}

void MarlinDriver::end(const char* how, double now_s) {
  if (end_job(how, now_s)) paused_ = false;
}

}  // namespace formwright
