// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// GRBL 1.1 and what speaks like it (grblHAL, FluidNC): lasers and mills on a serial line.
//
// Jobs are streamed by character counting (grbl/doc/markdown/interface.md, "Streaming a G-Code Program"). An "ok" says
// that a line was taken in, not that it was done: a job is done when every line is answered and the machine reports
// that it rests.
#include <array>
#include <deque>
#include <map>
#include <optional>

#include "machines/gcode_program.h"
#include "machines/grbl_report.h"
#include "machines/grbl_stream.h"
#include "machines/machine_driver.h"

namespace formwright {

class GrblDriver final : public MachineDriver {
 public:
  explicit GrblDriver(const DriverOptions& options) : options_(options) {}

  void opened(double now_s) override;
  void closed(double now_s) override;
  void received(ByteView bytes, double now_s) override;
  void tick(double now_s) override;
  void command(const Json& command, double now_s) override;
  std::unique_ptr<PreparedJob> prepare(ByteView job) const override;
  void load_prepared(const std::string& name, PreparedJob& job) override;
  Json state(double now_s) const override;

 private:
  // What arrives.
  void hear(const std::string& line, double now_s);
  void hear_answer(std::optional<int> error, double now_s);
  void hear_report(const GrblReport& report, double now_s);
  void hear_banner(const std::string& line, double now_s);
  void hear_alarm(int code, double now_s);
  void hear_message(const std::string& line, double now_s);

  // What is sent.
  void pump(double now_s);
  void send(GrblStream::Line line, double now_s);
  void queue(const std::string& line);
  void send_now(char real_time_command) { write_urgently(std::string_view(&real_time_command, 1)); }
  void reset(double now_s);
  void identify();

  // Jobs.
  /// Everything ends: motion held, then reset; nothing that was to be sent stays.
  void stop(const char* how, double now_s);
  void lose_position() { position_known_ = false; }

  // grbl_commands.cpp
  std::vector<std::string> possible_commands() const;
  void start(const Json& command, double now_s);
  void jog(const Json& command);
  void frame(const Json& command);
  void go_to(const Json& command);
  void set_origin(const Json& command);
  /// Where the origin will be, of the axes given: known at once, while the machine tells of it only in a report to
  /// come.
  void expect_origin(const std::array<std::optional<double>, 3>& machine_mm);
  bool origin_moves() const;
  /// Does a line that begins so wait to be sent, or to be answered?
  bool waits(std::string_view beginning) const;
  void focus(const Json& command, double now_s);
  void focus_off();
  void send_by_hand(const Json& command);
  void override_speeds(const Json& command);
  /// Where the bed begins along x or y, in machine coordinates.
  double reach_low(int axis) const;
  void check_reach(const GcodeBounds& bounds) const;
  std::vector<std::string> way_back_to(int index) const;
  int careful_line() const;
  double setting(int number, double fallback) const;
  double speed_mm_per_min(const Json& command, double fallback_mm_per_s) const;
  bool homes() const { return setting(22, 0) != 0; }

  DriverOptions options_;
  MachineConnection connection_ = MachineConnection::closed;
  MachinePhase phase_ = MachinePhase::unknown;
  std::string firmware_, option_letters_;
  std::map<int, double> settings_;
  std::optional<std::array<double, 3>> machine_mm_, work_mm_, offset_mm_;
  std::array<int, 3> overrides_{100, 100, 100};
  double feed_mm_per_min_ = 0, power_ = 0;
  bool position_known_ = false;

  GrblStream stream_;
  std::deque<std::string> by_hand_, after_banner_;
  int identifying_ = 0;  // lines of the identification that are not answered yet

  GcodeProgram program_;
  std::string program_name_;
  int next_line_ = 0;

  enum class Stopping { no, holding, resetting } stopping_ = Stopping::no;
  bool pause_asked_ = false, homing_ = false, limits_hit_ = false;
  std::optional<int> alarm_;
  struct RefusedLine {
    int code;
    std::string line;
    int line_number;
  };
  std::optional<RefusedLine> refused_;
  double opened_s_ = 0, heard_s_ = 0, asked_s_ = -1, stopping_s_ = 0, progress_s_ = 0, answered_s_ = 0,
         idle_since_s_ = -1;
  std::optional<double> focus_until_s_;
};

}  // namespace formwright
