// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A GRBL 1.1 machine that is not there: to practise on, and a strict judge of whoever sends to it.
//
// It has what makes senders fail: a serial buffer that loses what does not fit, a planner of 15 blocks, an EEPROM
// during whose writing nothing is heard, real-time commands that overtake, holds that take time, resets that lose
// steps, locks after alarms. The beam follows the firmware (grbl 1.1h: gcode.c steps 4 and 7, stepper.c st_prep_buffer,
// jog.c, protocol.c): a jog keeps the spindle's state, M3 shines at rest behind a cutting move, M4 in laser mode does
// not. Written from the firmware's documentation and from reading it; none of its code is used here.
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace formwright {

struct VirtualGrblOptions {
  double travel_x_mm = 400, travel_y_mm = 400, travel_z_mm = 80;
  bool homes = true, laser_mode = true, soft_limits = false;
  bool origin_low =
      false;  // homes to its lower left corner and calls that 0, as most small lasers do; else to the upper right
  double boot_s = 0.6, eeprom_s = 0.02, homing_s = 2.5;
  double acceleration_mm_per_s2 = 500;
  double rapid_mm_per_s = 150;
  bool resets_on_open = true;
  int planner_blocks = 15, rx_bytes = 128;
  bool error_latch = false;  // grblHAL protocol.c: behind a refused line every line of G-code is answered by its error
  bool grblhal = false;      // speaks and acts as grblHAL, with the latch, 100 blocks and 1024 bytes
};

class VirtualGrbl {
 public:
  using Point = std::array<double, 3>;

  explicit VirtualGrbl(const VirtualGrblOptions& options = {});
  VirtualGrbl(const VirtualGrbl&) = delete;  // what a line has still to do refers to its machine
  VirtualGrbl& operator=(const VirtualGrbl&) = delete;

  void open(double now_s);
  void receive(std::string_view bytes, double now_s);
  /// Lets time pass.
  void advance(double now_s);
  std::string take_output() { return std::exchange(output_, {}); }

  // To see and to disturb.
  struct Burn {
    Point from_mm, to_mm;  // where the head is, whatever the machine counts; the same where it rests
    double power;          // S
    double seconds = 0;
    bool jog = false;
  };
  /// The beam, whenever it was on.
  const std::vector<Burn>& burns() const { return burns_; }
  const std::vector<std::string>& lines() const { return lines_; }  // as they were taken out of the buffer
  int bytes_lost() const { return overrun_ + deaf_; }
  int planner_ran_dry() const { return ran_dry_; }
  /// Where the head is. After a power failure the machine counts from elsewhere.
  Point position_mm() const;
  /// Where the coordinates of a work system (54 to 59) are 0.
  Point origin_mm(int system) const;
  const std::string& state() const { return state_; }
  bool beam() const { return beam_; }
  /// Has it lines or moves that are not done?
  bool has_work() const { return !rx_.empty() || in_line_ || !planner_.empty(); }
  void trip_limit() { alarm(1); }
  void brown_out(double now_s) { boot(now_s); }
  /// The next line is answered by this error.
  void refuse_next(int code) { refuse_next_ = code; }
  /// So is every line that says this.
  void refuse_line(std::string line, int code) { refused_line_ = {std::move(line), code}; }
  void set_startup_line(int number, const std::string& line) { startup_.at(static_cast<std::size_t>(number)) = line; }
  void set_setting(int number, double value) { settings_[number] = value; }

 private:
  struct Block {
    Point to_mm;  // as the machine counts
    double speed_mm_per_s = 0, power = 0;
    int spindle = 5;
    bool jog = false, rapid = false;
    long serial = 0;
  };
  struct Modes {
    bool inches = false, relative = false, inverse_time = false;
    int motion = 0, plane = 17, system = 54, spindle = 5, flow = 0;
    double feed_mm_per_min = 0, power = 0;
    Point g92_mm{0, 0, 0};
    double tool_mm = 0;
  };
  struct Words;                        // of one line: virtual_grbl_gcode.cpp
  using Step = std::function<bool()>;  // true when it is done

  // virtual_grbl_hal.cpp: what grblHAL does otherwise
  void become_grblhal();
  unsigned char heard_as(unsigned char c);
  bool homing_required() const { return options_.grblhal && !homed_ && (static_cast<int>(settings_.at(22)) & 4) != 0; }
  void cancel_unread_lines();
  void report_build();
  void then_change_tool();

  // virtual_grbl.cpp
  void boot(double now_s);
  void reset();
  void alarm(int code);
  void real_time(unsigned char c);
  void step(double dt_s);

  // virtual_grbl_motion.cpp
  void move(double dt_s);
  void run(double dt_s);
  void come_to_rest();
  void hold_is_complete();
  void record_beam(const Point& from_mm, double seconds, double power, bool jog, long serial);
  void set_spindle(int state, double power);
  double output_of(double power) const;
  double stopping_distance_mm() const;
  bool laser_mode() const { return settings_.at(32) != 0; }
  bool at_rest() const { return planner_.empty() && state_ != "Run" && state_ != "Hold"; }

  // virtual_grbl_lines.cpp
  void read_line();
  void answer(int error);
  int act(const std::string& line);
  void run_steps();
  void then(Step step) { steps_.push_back(std::move(step)); }
  void then_wait_for_rest();
  void then_write_eeprom();
  void then_spindle(int state, double power);
  void run_startup_lines();
  void finish_line(int error);

  // virtual_grbl_settings.cpp
  int act_on_system_line(const std::string& line);
  int store_setting(const std::string& line);

  // virtual_grbl_gcode.cpp
  int act_on_gcode(const std::string& line, bool jog);
  int read_words(const std::string& line, bool jog, Words& words) const;
  int find_target(Words& words) const;
  void then_set_modes(const Words& words, Block& block);
  void then_non_modal(const Words& words, const Block& block);
  void then_end_program(int flow);
  void then_line(const Block& block);
  int then_arc(const Words& words, const Block& like);
  int jog(const Words& words);
  bool leaves_travel(const Point& to_mm) const;
  bool add_block(const Block& block);
  Point offset_mm(const Modes& modes) const;

  // virtual_grbl_report.cpp
  void report();
  void report_settings();
  void report_modes();
  void report_offsets();
  std::string place(const Point& mm) const;

  VirtualGrblOptions options_;
  std::map<int, double> settings_;
  std::array<std::string, 2> startup_;
  std::map<int, Point> systems_;  // 54 to 59, and 28 and 30
  std::string state_ = "Off", output_, rx_;
  std::deque<Block> planner_;
  std::deque<Step> steps_;  // what the line that is acted on has still to do
  std::deque<std::string> startup_left_;
  std::string startup_now_;
  bool in_line_ = false;
  Modes modes_;
  Point counted_mm_{0, 0, 0}, planned_mm_{0, 0, 0}, parsed_mm_{0, 0, 0};
  Point shift_mm_{0, 0, 0};  // where the head is, less what the machine counts
  std::vector<Burn> burns_;
  long burn_serial_ = -1, last_serial_ = 0, epoch_ = 0;
  std::vector<std::string> lines_;
  double time_s_ = 0, speed_mm_per_s_ = 0, boots_at_s_ = -1, deaf_until_s_ = -1, dwell_left_s_ = -1, homes_at_s_ = -1;
  double output_power_ = 0, reported_power_ = 0;
  int output_spindle_ = 5;
  bool homed_ = false;            // since it was switched on, and no step was lost
  bool keeps_printable_ = false;  // grblHAL: in a $ line ? ! ~ are text, unless $39
  double alarm_at_s_ = -1;
  int alarm_ = 0;
  bool beam_ = false, locked_ = false, dead_ = false, jog_cancelled_ = false, follows_speed_ = false;
  std::array<int, 3> overrides_{100, 100, 100};
  std::pair<std::string, int> refused_line_{"", 0};
  int overrun_ = 0, deaf_ = 0, ran_dry_ = 0, refuse_next_ = 0, last_error_ = 0, offset_reports_ = 0,
      override_reports_ = 0;
};

}  // namespace formwright
