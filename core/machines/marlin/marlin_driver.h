// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Marlin: 3D printers, and the lasers and mills built on their boards.
//
// Lines are numbered and carry a checksum (reprap.org/wiki/G-code, "Checking"); the machine asks for a line again when
// one arrived badly, and says "ok" once for every line and once more after each such request. One line is under way at
// a time.
//
// An ok means "taken in" and may be lost or come late, so it never tells that something has ended: what moved has ended
// when the machine reports its place in answer to an M114 that was sent behind it (and behind an M400, which waits for
// all moves).
//
// What turns something off leaves twice: at once and without a number, because the port may close before its turn, and
// in its turn with one, because only those are asked for again. Lines without a number are answered, too: until these
// answers are there no line is sent, so that none of them passes for its answer.
//
// The machine does numbered lines in their order or not at all, so an M5 ahead of a move is done before the move is
// (M5 waits for all moves: gcode/control/M3-M5.cpp). A line that turns the focus light on leaves in one write with the
// wait and the M5 that end it.
#include <array>
#include <deque>
#include <optional>

#include "machines/gcode/gcode_rules.h"
#include "machines/driver/machine_driver.h"
#include "machines/marlin/marlin_laser.h"
#include "machines/marlin/marlin_place.h"

namespace formwright {

/// "N3 G1 X5*29": the XOR of all characters before the star.
std::string numbered_line(int number, std::string_view line);

/// A job, and how it uses a laser.
struct MarlinJob {
  GcodeProgram program;
  MarlinLaserUse laser_use;
};

class MarlinDriver final : public MachineDriver {
 public:
  explicit MarlinDriver(const DriverOptions& options) : options_(options) {}

  void opened(double now_s) override;
  void closed(double now_s) override;
  void received(ByteView bytes, double now_s) override;
  void tick(double now_s) override;
  void command(const Json& command, double now_s) override;
  std::unique_ptr<PreparedJob> prepare(ByteView job) const override;
  void load_prepared(const std::string& name, PreparedJob& job) override;
  Json state(double now_s) const override;

 private:
  /// What has ended when the answer to a line's report of the place is there.
  enum class Settles { nothing, homing, moving, job };
  struct HandLine {
    std::string text;
    Settles settles = Settles::nothing;
  };
  struct SentLine {
    int number, job_line;
    std::string text;
    bool with_next = false;  // the next one leaves in the same write, now and whenever this one is asked for again
  };

  void hear(const std::string& line, double now_s);
  void hear_ok(const std::string& line, double now_s);
  void hear_resend(int number, double now_s);
  void hear_error(std::string_view text, double now_s);
  void hear_unknown(const std::string& text);
  void hear_report(const std::string& line, double now_s);
  void hear_idle(double now_s);
  void settled(double now_s);
  void go_on_unanswered(double now_s);
  void pump(double now_s);
  void settle(Settles what);
  void send(const HandLine& line, int job_line, double now_s);
  void send_again(double now_s);
  void send_focus_pulse(double now_s);
  void send_job_line(const std::string& line, double now_s);
  void keep(SentLine line);
  void greet(double now_s);
  void start_numbering(double now_s);
  void queue(const std::string& line, Settles settles = Settles::nothing) { by_hand_.push_back({line, settles}); }
  std::vector<std::string> lines_that_turn_off() const;
  void write_unnumbered(const std::string& line, double now_s);
  void turn_all_off_at_once(double now_s);
  void focus_off(double now_s);
  bool has_cutter() const { return options_.tool != MachineTool::printer; }
  /// Does the loaded job move the z of a mill? Its start then says where z is 0.
  bool asks_z() const { return options_.tool == MachineTool::mill && program_.bounds().named[2]; }
  /// Queues what makes sure that the beam or spindle is off, whatever mode it was left in.
  void queue_dark();
  /// Before moves by hand: dark, and in mm.
  void prepare_moves(double now_s);
  void watch_over_stop(double now_s);
  void ask_soon() { asked_s_ = -1e9; }  // where the head is, as soon as nothing else waits
  void move(const std::string& mode, const std::string& words, double speed_mm_per_s);
  void end(const char* how, double now_s);
  void stop(const char* how, double now_s);
  void halt(const std::string& text, double now_s);
  MachinePhase phase() const;
  /// Nothing is under way that must end first: lines are done in their order, so they may follow a jog.
  bool is_free() const;
  std::vector<std::string> possible_commands() const;
  void jog(const Json& command, double now_s);
  void set_origin(const Json& command, double now_s);
  /// The head's place becomes 0 on these axes (" X0 Y0").
  void zero_at_head(const std::string& words, double now_s);
  void start(const Json& command, double now_s);
  void resume();
  Json laser_on() const;
  void check_reach(const GcodeBounds& bounds) const;

  DriverOptions options_;
  MachineConnection connection_ = MachineConnection::closed;
  std::string firmware_;
  GcodeProgram program_;
  MarlinLaserUse laser_use_;  // of program_
  std::string program_name_;
  int next_line_ = 0;

  std::deque<HandLine> by_hand_;
  std::deque<SentLine> sent_;  // those that may be asked for again; the last `waiting_` of them are unanswered
  std::size_t resend_at_ = 0;  // index in sent_ of the next line to send again; sent_.size() when none
  int next_number_ = 0, oks_to_swallow_ = 0, resends_ = 0, unanswered_in_a_row_ = 0;
  int unnumbered_ = 0;                   // lines without a number that are not answered yet
  double unnumbered_s_ = 0;              // when one was written or answered last
  Settles settling_ = Settles::nothing;  // what is under way
  std::optional<int> settling_number_;   // of the M114 behind it, once that was sent
  int waiting_ = 0;                      // numbered lines that were written and not answered
  bool paused_ = false, halted_ = false, greeted_ = false;
  bool dark_ = false;      // an M5 was answered, and nothing that may light anything was sent since
  bool prepared_ = false;  // the last lines queued by hand are prepare_moves() and jogs
  bool darkened_ = false;  // the M5 ahead of the greeting was written
  bool rests_ = false;     // an M400 was sent ahead of the job's next line
  bool no_m5_ = false;     // the firmware does not know it
  MarlinPlace place_;
  std::optional<double> z_set_s_;              // when z was last set to 0 at the head; none after homing
  std::optional<MarlinPlace::Limits> limits_;  // M211
  std::string halt_text_;
  Json temperatures_ = Json::object();
  std::optional<std::string> refused_;
  double opened_s_ = 0, heard_s_ = 0, sent_s_ = 0, asked_s_ = 0, stopped_s_ = -1;
  std::optional<double> focus_until_s_;
  std::string focus_line_;                 // "M3 S2.55"
  std::optional<double> jogging_until_s_;  // by its length and speed: an M400 would halt a key held down at every step
};

}  // namespace formwright
