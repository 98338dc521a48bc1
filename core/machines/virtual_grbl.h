// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A GRBL 1.1 laser that is not there: to practise on, and a strict judge of whoever sends to it.
//
// It has what makes senders fail: a serial buffer of 128 bytes that loses what does not fit, a planner of 15 blocks, an
// EEPROM during whose writing nothing is heard, real-time commands that overtake, holds that take time, resets that
// lose steps, locks after alarms. Behaviour from GRBL's own documentation (doc/markdown/interface.md, commands.md,
// settings.md) and sources, none of which is used here.
#include <array>
#include <cstdint>
#include <deque>
#include <map>
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
};

class VirtualGrbl {
 public:
  explicit VirtualGrbl(const VirtualGrblOptions& options = {});

  void open(double now_s);
  void receive(std::string_view bytes, double now_s);
  /// Lets time pass.
  void advance(double now_s);
  std::string take_output() { return std::exchange(output_, {}); }

  // To see and to disturb.
  struct Burn {
    std::array<double, 3> from_mm, to_mm;  // machine coordinates
    double power;
  };
  const std::vector<Burn>& burns() const { return burns_; }
  const std::vector<std::string>& lines() const { return lines_; }  // as they were taken out of the buffer
  int bytes_lost() const { return overrun_ + deaf_; }
  int planner_ran_dry() const { return ran_dry_; }
  std::array<double, 3> position_mm() const { return position_mm_; }
  const std::string& state() const { return state_; }
  bool beam() const { return beam_; }
  void trip_limit() { alarm(1); }
  void brown_out(double now_s) { boot(now_s); }
  /// The next line is answered by this error.
  void refuse_next(int code) { refuse_next_ = code; }

 private:
  struct Block {
    std::array<double, 3> to_mm;
    double speed_mm_per_s = 0, power = 0;
    bool burns = false, jog = false;
    bool follows_speed = false;  // M4: power goes with the speed
  };
  struct Modes {
    bool inches = false, relative = false;
    int motion = 0, spindle = 5;
    double feed_mm_per_min = 0, power = 0;
    std::array<double, 3> offset_mm{0, 0, 0};
  };

  void boot(double now_s);
  void reset();
  void alarm(int code);
  void real_time(unsigned char c);
  void step(double dt_s);
  void move(double dt_s);
  void read_line();
  int act(const std::string& line);  // the error, or 0; -1: answered later
  int act_on_setting(const std::string& line);
  int act_on_gcode(const std::string& line, bool jog);
  int add_arc(const std::array<double, 3>& to_mm, double i_mm, double j_mm, const Block& like);
  int write_eeprom();
  int add_block(const Block& block);
  void report();
  void answer(int error);
  double stopping_distance_mm() const;

  VirtualGrblOptions options_;
  std::map<int, double> settings_;
  std::string state_ = "Off", output_, rx_, line_;
  std::deque<Block> planner_;
  Modes modes_;
  std::array<double, 3> position_mm_{0, 0, 0}, planned_mm_{0, 0, 0}, burn_from_mm_{0, 0, 0};
  std::vector<Burn> burns_;
  std::vector<std::string> lines_;
  double time_s_ = 0, speed_mm_per_s_ = 0, boots_at_s_ = -1, deaf_until_s_ = -1, dwell_until_s_ = -1, homes_at_s_ = -1;
  bool holding_ = false, beam_ = false, locked_ = false, dead_ = false, program_pause_ = false, jog_cancelled_ = false;
  std::array<int, 3> overrides_{100, 100, 100};
  int overrun_ = 0, deaf_ = 0, ran_dry_ = 0, refuse_next_ = 0, reports_ = 0;
};

}  // namespace formwright
