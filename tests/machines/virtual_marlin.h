// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A Marlin laser that is not there, as its sources say (MarlinFirmware/Marlin, Marlin/src): lines read into a ring of
// four (gcode/queue.cpp), commands done in their order, each answered when it returns (gcode/gcode.cpp), sixteen
// planned blocks (module/planner.h), and the laser's modes (gcode/control/M3-M5.cpp, feature/spindle_laser.h,
// module/stepper.cpp). It works in steps of a clock that the test moves, and tells where it shines.
#include <array>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "base/random.h"

namespace formwright {

struct VirtualMarlinOptions {
  bool inline_modes = true;       // 2.1 with LASER_FEATURE; 1.1 and 2.0 take "M3 I" for "M3"
  bool safety_timeout = false;    // LASER_SAFETY_TIMEOUT_MS 1000 (module/temperature.cpp)
  bool emergency_parser = false;  // M108, M112 and M410 act as they arrive, not in their turn
  bool advanced_ok = false;       // "ok N12 P15 B3"
  std::array<double, 3> bed_mm{300, 200, 50};
};

class VirtualMarlin {
 public:
  VirtualMarlin(const VirtualMarlinOptions& options, std::uint64_t seed);

  void receive(std::string_view bytes);
  std::string take_output();
  void advance(double seconds);
  /// Power gone and back: nothing is kept but where the head stands.
  void restart();

  bool shines() const { return output_ > 0; }
  bool moves() const { return block_.has_value(); }
  bool halted() const { return halted_; }
  /// On the bed, from where homing ends.
  std::array<double, 3> head_mm() const;
  /// Where work's zero lies on the bed.
  std::array<double, 3> work_zero_mm() const;
  double now_s() const { return now_s_; }

  double spoil = 0;  // of the lines that arrive, how many have a bit fallen over
  long homed_times = 0;

 private:
  enum class Mode { standard, continuous, dynamic };
  struct Block {
    std::array<double, 3> to_mm;
    double speed_mm_per_s;
    double power;
  };
  struct Command {
    std::string text;
    std::optional<long> number;
    bool started = false;
    double until_s = 0;
  };
  struct Words {
    std::string text;
    std::optional<double> number(char letter) const;
    bool has(char letter) const { return text.find(letter, 1) != std::string::npos; }
  };

  void read_serial();
  void hear_line(std::string line);
  void ask_again(const std::string& why);
  void at_once(std::string_view command);
  void run_commands();
  /// False while the command waits for something.
  bool run(Command& command);
  bool run_g(Command& command, const Words& words, int code);
  bool run_m(Command& command, const Words& words, int code);
  bool plan(const Words& words, bool rapid);
  bool home(Command& command, const Words& words);
  bool turn_on(const Words& words, bool m4);
  void quick_stop();
  void kill();
  void step(double seconds);
  bool drained() const { return !block_ && blocks_.empty() && now_s_ >= discarding_until_s_; }
  void answer(const Command& command);

  VirtualMarlinOptions options_;
  Random random_;
  double now_s_ = 0, boots_at_s_ = 0.5;
  bool booted_ = false, halted_ = false;
  std::string rx_, line_, output_text_;
  std::deque<Command> ring_;
  long last_number_ = 0;
  double busy_said_s_ = 0;

  std::deque<Block> blocks_;
  std::optional<Block> block_;
  std::array<double, 3> at_mm_{}, planned_mm_{}, offset_mm_{}, zero_mm_{};  // zero_: of the machine, on the bed
  double feed_mm_per_s_ = 25, discarding_until_s_ = 0, moved_s_ = 0;
  bool relative_ = false;

  Mode mode_ = Mode::standard;
  double output_ = 0, inline_power_ = 0;
  bool inline_enabled_ = false, powered_ = false;
};

}  // namespace formwright
