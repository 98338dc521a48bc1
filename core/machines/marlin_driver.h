// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Marlin: 3D printers, and the lasers and mills built on their boards.
//
// Lines are numbered and carry a checksum (reprap.org/wiki/G-code, "Checking"); the machine asks for a line again when one arrived badly,
// and says "ok" once for every line and once more after each such request. One line is under way at a time.
#include <array>
#include <deque>
#include <optional>

#include "machines/gcode_program.h"
#include "machines/machine_driver.h"

namespace formwright {

/// "N3 G1 X5*29": the XOR of all characters before the star.
std::string numbered_line(int number, std::string_view line);

class MarlinDriver final : public MachineDriver {
 public:
  explicit MarlinDriver(const DriverOptions& options) : options_(options) {}

  void opened(double now_s) override;
  void closed(double now_s) override;
  void received(ByteView bytes, double now_s) override;
  void tick(double now_s) override;
  void command(const Json& command, double now_s) override;
  void load(const std::string& name, ByteView job) override;
  Json state(double now_s) const override;

 private:
  struct SentLine {
    int number, job_line;
    std::string text;
  };

  void hear(const std::string& line, double now_s);
  void hear_ok(const std::string& line, double now_s);
  void hear_resend(int number, double now_s);
  void hear_temperatures(const std::string& line);
  void pump(double now_s);
  void send(const std::string& text, int job_line, double now_s);
  void start_numbering(double now_s);
  void queue(const std::string& line) { by_hand_.push_back(line); }
  void move(const std::string& mode, const std::string& words, double speed_mm_per_s);
  void end(const char* how, double now_s);
  void stop(const char* how, double now_s);
  void halt(const std::string& text, double now_s);
  MachinePhase phase() const;
  std::vector<std::string> possible_commands() const;
  void start(const Json& command, double now_s);
  void check_reach(const GcodeBounds& bounds) const;

  DriverOptions options_;
  MachineConnection connection_ = MachineConnection::closed;
  std::string firmware_;
  GcodeProgram program_;
  std::string program_name_;
  int next_line_ = 0;

  std::deque<std::string> by_hand_;
  std::deque<SentLine> sent_;  // those that may be asked for again; the last `waiting_` of them are unanswered
  std::size_t resend_at_ = 0;  // index in sent_ of the next line to send again; sent_.size() when none
  int next_number_ = 0, oks_to_swallow_ = 0, resends_ = 0;
  bool waiting_ = false, paused_ = false, position_known_ = false, homing_ = false, halted_ = false, draining_ = false, greeted_ = false;
  std::string halt_text_;
  std::optional<std::array<double, 3>> position_mm_;
  Json temperatures_ = Json::object();
  std::optional<std::string> refused_;
  double opened_s_ = 0, heard_s_ = 0, asked_s_ = 0, stopped_s_ = -1;
  std::optional<double> focus_until_s_;
};

}  // namespace formwright
