// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// GRBL 1.1 and what speaks like it (grblHAL, FluidNC): lasers and mills on a serial line.
//
// Jobs are streamed by character counting (grbl/doc/markdown/interface.md, "Streaming a G-Code Program"). An "ok" says
// that a line was taken in, not that it was done: a job is done when every line is answered and the machine reports
// that it rests.
//
// The beam is dark whenever no stroke is burnt: M5 is answered before the head moves by a jog or homes, stands in front
// of every job and behind it; laser jobs are sent with M4, which is dark at rest whoever stops sending.
#include <array>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "machines/gcode/gcode_rules.h"
#include "machines/grbl/grbl_machine.h"
#include "machines/grbl/grbl_power.h"
#include "machines/grbl/grbl_report.h"
#include "machines/grbl/grbl_stream.h"
#include "machines/driver/machine_driver.h"

namespace formwright {

/// A job with what is asked of it at every start.
struct GrblJob {
  GcodeProgram program;
  LaserPower power;
  std::array<bool, 2> unplaced{};
  std::array<bool, 3> moves_axis{};
  int mist_line = 0;
};

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
  // grbl_hearing.cpp: what arrives.
  void hear(const std::string& line, double now_s);
  void hear_answer(std::optional<int> error, double now_s);
  void hear_job_answer(const GrblStream::Line& line, std::optional<int> error, double now_s);
  bool refuses_foreign_line(const GrblStream::Line* line, int error) const;
  void end_foreign_lines(double now_s);
  void hear_report(const GrblReport& report, double now_s);
  void hear_places(const GrblReport& report);
  void hear_banner(const std::string& line, double now_s);
  void hear_alarm(int code, double now_s);

  // grbl_driver.cpp: what is sent.
  void pump(double now_s);
  bool pump_by_hand(double now_s);
  void pump_job(double now_s);
  void send(GrblStream::Line line, double now_s);
  bool speaks_grblhal() const { return machine_.kind() == GrblFirmware::grblhal; }
  /// The real-time commands that grblHAL hears wherever they stand; GRBL knows the printable ones only.
  char ask_report() const { return speaks_grblhal() ? char(0x80) : '?'; }
  char cycle_start() const { return speaks_grblhal() ? char(0x81) : '~'; }
  char feed_hold() const { return speaks_grblhal() ? char(0x82) : '!'; }
  void queue(const std::string& line) { by_hand_.push_back(line); }
  void send_now(char real_time_command) { write_urgently(std::string_view(&real_time_command, 1)); }
  void reset(double now_s);
  void identify();
  /// Everything ends: motion held, then reset; nothing that was to be sent stays.
  void stop(const char* how, double now_s);
  void lose_position() { axes_known_ = {}; }
  void watch_silence(double now_s);

  // grbl_light.cpp: where the beam is on, and that it goes out.
  /// True where `line` must wait until M5 is answered; sends that.
  bool waits_for_dark(const std::string& line, double now_s);
  void heed_light(const std::string& line);
  void hear_dark(std::optional<int> error, double now_s);
  void watch_light(double now_s);
  void cancel_jog(double now_s);
  /// grblHAL drops what it has not read when a jog is cancelled, so that some lines are never answered.
  void settle_cancelled_jog(double now_s);
  void focus(const Json& command, double now_s);
  void send_pulse(double now_s);
  void hear_pulse(const GrblStream::Line& line, std::optional<int> error, double now_s);
  Json laser_on() const;
  /// On boards that let the beam shine on in a hold (grblHAL $63), while the job is sent with M3.
  bool hold_keeps_beam() const { return !dynamic_power() && !machine_.setting_has_bit(63, 0, true); }
  bool is_laser() const { return options_.tool == MachineTool::laser; }

  // grbl_start.cpp: whether, and how, a job begins.
  void start(const Json& command, double now_s);
  void check_settings() const;
  void check_reach(const GcodeBounds& bounds) const;
  void require_first_cut_placed(int index) const;
  /// Where the head must be known for the job that is loaded, and is not: a sentence, or "".
  std::string unknown_place() const;
  /// Does the loaded job move the z of a mill? Its start then says where z is 0.
  bool asks_z() const { return options_.tool == MachineTool::mill && moves_axis_[2]; }
  std::vector<std::string> lines_back_to(int index) const;
  int careful_line() const;
  std::string as_sent(std::string_view line) const {
    return dynamic_power() ? with_dynamic_power(line) : std::string(line);
  }
  /// Are lines sent with M4 for M3?
  bool dynamic_power() const { return is_laser() && power_wanted_.rest_line == 0; }
  Json warnings() const;
  std::string when_connection_ends() const;
  /// Where the bed begins along x or y, in machine coordinates.
  double reach_low(int axis) const;

  // grbl_commands.cpp
  std::vector<std::string> possible_commands() const;
  void refuse_now(const std::string& what) const;
  void act_on(const std::string& what, const Json& command, double now_s);
  void home(const Json& command, double now_s);
  void jog(const Json& command);
  void frame(const Json& command);
  void go_to(const Json& command);
  void set_origin(const Json& command);
  /// Jobs, frames and the origin are in G54.
  void select_job_system();
  /// Where the origin will be, of the axes given: known at once, while the machine tells of it only in a report to
  /// come.
  void expect_origin(const std::array<std::optional<double>, 3>& machine_mm);
  bool origin_moves() const { return waits("G10") || waits("G54"); }
  /// Does a line that begins so wait to be sent, or to be answered?
  bool waits(std::string_view beginning) const;
  /// Is a line that moves the head not sent, or not answered, yet?
  bool waits_for_motion() const;
  void send_by_hand(const Json& command);
  void override_speeds(const Json& command);
  double setting(int number, double fallback) const { return machine_.setting(number, fallback); }
  double speed_mm_per_min(const Json& command, double fallback_mm_per_s) const;
  bool homes() const { return machine_.setting_has_bit(22, 0, false); }
  /// Does homing find this axis's place?
  bool homes_axis(std::size_t axis) const { return homes() && machine_.homed_axes()[axis]; }
  bool place_known() const { return axes_known_[0] && axes_known_[1]; }

  DriverOptions options_;
  MachineConnection connection_ = MachineConnection::closed;
  MachinePhase phase_ = MachinePhase::unknown;
  GrblMachine machine_;
  std::optional<std::array<double, 3>> machine_mm_, work_mm_, offset_mm_;
  std::array<int, 3> overrides_{100, 100, 100};
  double feed_mm_per_min_ = 0;
  std::array<bool, 3> axes_known_{};
  std::optional<double> z_set_s_;  // when z was last set to 0 at the head, in this connection

  GrblStream stream_;
  std::deque<std::string> by_hand_, after_banner_;
  int identifying_ = 0;         // lines of the identification that are not answered yet
  int identified_ = 0;          // how often it was asked for
  bool version_heard_ = false;  // since then: what is answered is what was asked
  int foreign_resets_ = 0;
  bool refused_before_ = false;

  GcodeProgram program_;
  std::string program_name_;
  LaserPower power_wanted_;
  std::array<bool, 3> moves_axis_{};  // of the job
  std::array<bool, 2> unplaced_{};    // when its first cut begins
  int first_line_ = 0, next_line_ = 0;
  bool closing_sent_ = false;  // the M5 behind the job

  enum class Stopping { no, holding, resetting } stopping_ = Stopping::no;
  bool pause_asked_ = false, homing_ = false;
  bool needs_reset_ = false;  // it hears nothing else
  bool pendant_ = false;      // a hand-held control has the machine
  bool tool_change_ = false;
  std::optional<int> alarm_;
  struct RefusedLine {
    int code;
    std::string line;
    int line_number;
  };
  std::optional<RefusedLine> refused_;
  double opened_s_ = 0, heard_s_ = 0, asked_s_ = -1, stopping_s_ = 0, progress_s_ = 0, answered_s_ = 0,
         idle_since_s_ = -1;

  std::optional<double> power_;     // S as the machine reports it
  std::optional<bool> spindle_on_;  // A:S or A:C
  bool dark_ = false;               // M5 is answered, and nothing that could change that was sent behind it
  bool darkening_ = false;          // M5 is sent
  bool light_behind_dark_ = false;  // something that could turn the beam on was sent behind it
  bool light_by_hand_ = false;      // the person has turned it on with a line
  bool ended_badly_ = false;        // M5 is owed once the machine takes lines again
  int dark_refused_ = 0;
  double stray_since_s_ = -1;
  double homing_since_s_ = 0;
  double reset_sent_s_ = 0;
  int resets_ = 0;
  double jog_cancelled_s_ = -1;  // until what was sent before is answered or known to be dropped
  std::optional<double> focus_until_s_;
  std::string focus_power_;
  int pulses_ = 0;      // of this focus
  bool pulse_ = false;  // one is under way
};

}  // namespace formwright
