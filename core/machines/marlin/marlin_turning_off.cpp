// SPDX-License-Identifier: GPL-3.0-or-later
// How a Marlin machine is stopped, and how its beam, spindle and heaters go off.
#include <algorithm>

#include "machines/marlin/marlin_driver.h"

namespace formwright {
namespace {

constexpr double escalation_s = 2;
constexpr double quiet_s = 1.5;  // an M410 may take a second to be answered
constexpr const char *focus_wait = "G4 P250", *beam_off = "M5", *beam_off_inline = "M5 I";

}  // namespace

void MarlinDriver::stop(const char* how, double now_s) {
  end(how, now_s);
  by_hand_.clear();
  drop_output();
  // A line that did not leave or did not arrive will be asked for by its number: it must not move anything then.
  for (SentLine& line : sent_)
    if (!line.text.starts_with("M110") && !line.text.starts_with(beam_off)) line = {line.number, -1, "M105"};
  resend_at_ = sent_.size();
  place_.lose();
  settling_ = Settles::nothing;
  settling_number_.reset();
  focus_until_s_.reset();
  jogging_until_s_.reset();
  oks_to_swallow_ = 0;
  turn_all_off_at_once(now_s);
  for (const std::string& line : lines_that_turn_off()) queue(line);
  if (options_.tool == MachineTool::laser) queue(beam_off_inline);
  stopped_s_ = now_s;
}

void MarlinDriver::queue_dark() {
  queue(beam_off);
  queue(beam_off_inline);
  if (laser_use_.fan) queue("M107");
}

void MarlinDriver::prepare_moves(double now_s) {
  if (focus_until_s_) focus_off(now_s);
  else if (has_cutter()) queue_dark();
  queue("G21");
}

void MarlinDriver::send_focus_pulse(double now_s) {
  // In one write: where the computer dies behind it, the machine still has what turns it off.
  std::string together;
  for (const std::string& text : {focus_line_, std::string(focus_wait), std::string(beam_off)}) {
    const int number = next_number_++;
    together += numbered_line(number, text) + "\n";
    keep({number, -1, text, text != beam_off});
    ++waiting_;
  }
  write(together);
  sent_s_ = now_s;
  dark_ = false;
}

void MarlinDriver::focus_off(double now_s) {
  focus_until_s_.reset();
  // A light that is not on yet never comes on.
  for (SentLine& line : sent_)
    if (line.text == focus_line_) line.text = "M105";
  write_unnumbered(beam_off, now_s);
  queue_dark();
}

void MarlinDriver::watch_over_stop(double now_s) {
  if (unnumbered_ > 0 && waiting_ == 0 && now_s - unnumbered_s_ > quiet_s) unnumbered_ = 0;  // these were not answered
  if (stopped_s_ < 0) return;
  // Where nothing can be sent now, nothing is waited for.
  const bool sends = greeted_ && !halted_ && connection_ != MachineConnection::silent;
  if (waiting_ == 0 && unnumbered_ == 0 && (by_hand_.empty() || !sends)) stopped_s_ = -1;
  else if (waiting_ > 0 && now_s - std::max(stopped_s_, sent_s_) > escalation_s) {
    // M410 was not heard: boards without an emergency parser take it in turn only. M112 ends everything.
    write_urgently("M112\n");
    halt("it did not stop when asked, so it was sent M112.", now_s);
  }
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

}  // namespace formwright
