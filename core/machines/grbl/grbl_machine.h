// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a GRBL machine says of itself when it is asked: $I, $$, $N, $G and $# (grbl/doc/markdown/interface.md,
// "Feedback Messages").
#include <array>
#include <map>
#include <optional>
#include <string>

#include "machines/grbl/grbl_words.h"

namespace formwright {

class GrblMachine {
 public:
  using Point = std::array<double, 3>;

  /// "$30=1000", "$N0=", "[OPT:...]", "[GC:...]", "[G54:...]" and the like. Anything else changes nothing.
  void hear(const std::string& line);
  /// Follows what a line sent by hand changes, once it is answered.
  void follow(const std::string& line);
  /// As after a reset: gcode.c gc_init.
  void reset_parser();

  double setting(int number, double fallback) const;
  bool has_settings() const { return !settings_.empty(); }
  void forget_settings() { settings_.clear(), settings_asked_ = false; }
  /// $$ was answered, if only by an error.
  void settings_answered() { settings_asked_ = true; }
  /// Are reports in inches ($13)? None while that is not known: lengths mean nothing then.
  std::optional<bool> reports_inches() const;

  std::string firmware() const { return firmware_; }
  GrblFirmware kind() const { return kind_; }
  /// The line that the machine says when it starts, "Grbl 1.1h ['$' for help]" and the like.
  void hear_banner(const std::string& line);
  bool setting_has_bit(int number, int bit, bool fallback) const;
  /// Which axes know their place behind $H: $44 to $46 name them on grblHAL, all do elsewhere.
  std::array<bool, 3> homed_axes() const;
  /// False until [OPT:...] was heard.
  bool tells_options() const { return !option_letters_.empty(); }
  bool has_option(char letter) const { return option_letters_.find(letter) != std::string::npos; }
  /// Moves that may be answered and not done yet.
  int planner_blocks() const { return planner_blocks_; }
  std::optional<int> buffer_bytes() const { return buffer_bytes_; }

  int work_system() const { return work_system_; }
  bool spindle_on() const { return spindle_ != 5; }
  /// Machine minus work coordinates in a work system, as far as $# reported it.
  std::optional<Point> offset_mm(int system) const;
  /// What of the parser's state would carry a job elsewhere than it says, as a sentence; "" for nothing.
  std::string misplaces() const;
  /// A sentence where the settings let the beam shine though it is turned off, or in laser mode at rest; "" where not.
  std::string keeps_beam_on() const;
  /// A sentence where the machine runs a line by itself that moves or fires; "" where it does not.
  std::string runs_by_itself() const;

 private:
  void hear_options(const std::string& options);
  void hear_modes(const std::string& modes);

  std::string firmware_, option_letters_;
  std::map<int, double> settings_;
  bool settings_asked_ = false;
  std::array<std::string, 2> startup_;
  int planner_blocks_ = 15;
  std::optional<int> buffer_bytes_;
  GrblFirmware kind_ = GrblFirmware::grbl;
  int work_system_ = 54, spindle_ = 5;
  bool scaled_ = false;  // G51
  std::map<int, Point> offsets_mm_;
  Point g92_mm_{0, 0, 0};
  double tool_mm_ = 0;
};

}  // namespace formwright
