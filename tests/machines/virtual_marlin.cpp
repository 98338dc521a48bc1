// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/virtual_marlin.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>

namespace formwright {
namespace {

constexpr std::size_t ring_lines = 4, rx_bytes = 128,
                      planner_blocks = 16;  // BUFSIZE, RX_BUFFER_SIZE, BLOCK_BUFFER_SIZE
constexpr double startup_power = 204;       // SPEED_POWER_STARTUP, 80 %
constexpr double discard_s = 1;             // cleaning_buffer_counter
constexpr double home_mm_per_s = 50, busy_s = 2, boot_s = 0.5, safety_s = 1;
constexpr std::string_view axes = "XYZ";

}  // namespace

std::optional<double> VirtualMarlin::Words::number(char letter) const {
  const std::size_t at = text.find(letter, 1);
  if (at == std::string::npos) return std::nullopt;
  const char* start = text.c_str() + at + 1;
  char* end = nullptr;
  const double value = std::strtod(start, &end);
  return end == start ? std::nullopt : std::optional(value);
}

VirtualMarlin::VirtualMarlin(const VirtualMarlinOptions& options, std::uint64_t seed)
    : options_(options), random_(seed) {
  for (std::size_t axis = 0; axis < 3; ++axis) zero_mm_[axis] = options.bed_mm[axis] * random_.uniform();
}

void VirtualMarlin::restart() {
  zero_mm_ = head_mm();
  at_mm_ = planned_mm_ = offset_mm_ = {};
  rx_.clear(), line_.clear(), output_text_.clear();
  ring_.clear(), blocks_.clear(), block_.reset();
  last_number_ = homed_times = 0;
  relative_ = halted_ = booted_ = inline_enabled_ = powered_ = false;
  mode_ = Mode::standard;
  output_ = inline_power_ = 0;
  boots_at_s_ = now_s_ + boot_s;
}

std::array<double, 3> VirtualMarlin::head_mm() const {
  return {zero_mm_[0] + at_mm_[0], zero_mm_[1] + at_mm_[1], zero_mm_[2] + at_mm_[2]};
}

std::array<double, 3> VirtualMarlin::work_zero_mm() const {
  return {zero_mm_[0] + offset_mm_[0], zero_mm_[1] + offset_mm_[1], zero_mm_[2] + offset_mm_[2]};
}

std::string VirtualMarlin::take_output() { return std::exchange(output_text_, {}); }

void VirtualMarlin::receive(std::string_view bytes) {
  if (!booted_ || halted_) return;
  for (const char c : bytes)
    if (rx_.size() < rx_bytes) rx_ += c;  // the rest is lost
  if (options_.emergency_parser)
    for (const char* command : {"M410\n", "M112\n"})
      if (bytes.find(command) != std::string_view::npos) at_once(std::string_view(command, 4));
  read_serial();
}

void VirtualMarlin::advance(double seconds) {
  now_s_ += seconds;
  if (!booted_ && now_s_ >= boots_at_s_) {
    booted_ = true;
    output_text_ += options_.inline_modes ? "start\nMarlin 2.1.2.5\n" : "start\nMarlin 1.1.9\n";
  }
  if (!booted_ || halted_) return;
  step(seconds);
  read_serial();
  run_commands();
}

void VirtualMarlin::read_serial() {
  while (ring_.size() < ring_lines && !rx_.empty() && !halted_) {
    const char c = rx_.front();
    rx_.erase(0, 1);
    if (c != '\n') {
      line_ += c;
      continue;
    }
    std::string line = std::exchange(line_, {});
    if (!line.empty() && random_.uniform() < spoil) line[random_.below(line.size())] ^= 0x04;
    if (!line.empty()) hear_line(std::move(line));
  }
}

/// queue.cpp, get_serial_commands().
void VirtualMarlin::hear_line(std::string line) {
  std::optional<long> number;
  const std::size_t star = line.rfind('*');
  if (line[0] == 'N') {
    number = std::strtol(line.c_str() + 1, nullptr, 10);
    const bool sets = line.find("M110") != std::string::npos;
    if (*number != last_number_ + 1 && !sets) return ask_again("Line Number is not Last Line Number+1");
    unsigned sum = 0;
    for (std::size_t i = 0; i < std::min(star, line.size()); ++i) sum ^= static_cast<unsigned char>(line[i]);
    if (star == std::string::npos) return ask_again("No Checksum with line number");
    if (std::to_string(sum) != line.substr(star + 1)) return ask_again("checksum mismatch");
    last_number_ = *number;
    const std::size_t space = line.find(' ');
    line = space == std::string::npos ? "" : line.substr(space + 1, star - space - 1);
  } else if (star != std::string::npos) return ask_again("No Line Number with checksum");
  if (!options_.emergency_parser) at_once(line);
  if (!halted_) ring_.push_back({line, number});
}

void VirtualMarlin::ask_again(const std::string& why) {
  rx_.clear();
  line_.clear();
  output_text_ += "Error:" + why + ", Last Line: " + std::to_string(last_number_) +
                  "\nResend: " + std::to_string(last_number_ + 1) + "\nok\n";
}

void VirtualMarlin::at_once(std::string_view command) {
  if (command == "M112") kill();
  if (command == "M410") quick_stop();
}

void VirtualMarlin::kill() {
  halted_ = true;
  output_ = 0;
  blocks_.clear(), block_.reset(), ring_.clear();
  output_text_ += "Error:Printer halted. kill() called!\n";
}

/// Drops what is planned, and every move of the next second; the laser stays as it is.
void VirtualMarlin::quick_stop() {
  blocks_.clear(), block_.reset();
  planned_mm_ = at_mm_;
  discarding_until_s_ = now_s_ + discard_s;
}

void VirtualMarlin::answer(const Command& command) {
  output_text_ += "ok";
  if (options_.advanced_ok) {
    if (command.number) output_text_ += " N" + std::to_string(*command.number);
    output_text_ +=
        " P" + std::to_string(planner_blocks - 1 - blocks_.size()) + " B" + std::to_string(ring_lines - ring_.size());
  }
  output_text_ += "\n";
}

void VirtualMarlin::run_commands() {
  while (!ring_.empty() && !halted_) {
    Command& command = ring_.front();
    if (!run(command)) {
      if (now_s_ - busy_said_s_ > busy_s) output_text_ += "echo:busy: processing\n", busy_said_s_ = now_s_;
      return;
    }
    busy_said_s_ = now_s_;
    const Command done = command;
    ring_.pop_front();
    answer(done);
    read_serial();
  }
}

bool VirtualMarlin::run(Command& command) {
  const Words words{command.text};
  if (words.text.empty()) return true;
  const int code = std::atoi(words.text.c_str() + 1);
  if (words.text[0] == 'G') return run_g(command, words, code);
  if (words.text[0] == 'M') return run_m(command, words, code);
  output_text_ += "echo:Unknown command: \"" + words.text + "\"\n";
  return true;
}

bool VirtualMarlin::run_g(Command& command, const Words& words, int code) {
  switch (code) {
    case 0:
    case 1: return plan(words, code == 0);
    case 4:
      if (!command.started) {
        if (!drained()) return false;
        command.started = true;
        command.until_s = now_s_ + words.number('S').value_or(0) + 1e-3 * words.number('P').value_or(0);
      }
      return now_s_ >= command.until_s;
    case 28: return home(command, words);
    case 90:
    case 91: relative_ = code == 91; return true;
    case 92:
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (const auto value = words.number(axes[axis])) offset_mm_[axis] = planned_mm_[axis] - *value;
      return true;
    default: return true;
  }
}

bool VirtualMarlin::plan(const Words& words, bool rapid) {
  if (blocks_.size() >= planner_blocks) return false;
  if (const auto feed = words.number('F'); feed && *feed > 0) feed_mm_per_s_ = *feed / 60;
  if (mode_ != Mode::standard) {
    // gcode.cpp, get_destination_from_command()
    if (rapid) inline_power_ = 0, powered_ = mode_ != Mode::dynamic && powered_;
    else {
      powered_ = true;
      if (const auto power = words.number('S')) inline_power_ = std::clamp(*power, 0.0, 255.0);
    }
  }
  std::array<double, 3> to = planned_mm_;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (const auto value = words.number(axes[axis]))
      to[axis] = relative_ ? to[axis] + *value : offset_mm_[axis] + *value;
  if (now_s_ < discarding_until_s_ || to == planned_mm_) return true;
  blocks_.push_back({to, feed_mm_per_s_, powered_ && inline_enabled_ ? inline_power_ : 0});
  planned_mm_ = to;
  return true;
}

/// The moves of homing carry the power that an inline mode was left with.
bool VirtualMarlin::home(Command& command, const Words& words) {
  if (!drained()) return false;
  if (!command.started) {
    command.started = true;
    const bool any = words.has('X') || words.has('Y') || words.has('Z');
    std::array<double, 3> to = at_mm_;
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (!any || words.has(axes[axis])) to[axis] = -zero_mm_[axis];
    blocks_.push_back({to, home_mm_per_s, powered_ && inline_enabled_ ? inline_power_ : 0});
    planned_mm_ = to;
    return false;
  }
  const bool any = words.has('X') || words.has('Y') || words.has('Z');
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (!any || words.has(axes[axis])) zero_mm_[axis] = at_mm_[axis] = planned_mm_[axis] = offset_mm_[axis] = 0;
  ++homed_times;
  return true;
}

bool VirtualMarlin::turn_on(const Words& words, bool m4) {
  const bool with_i = options_.inline_modes && words.has('I');
  if (!drained()) return false;
  moved_s_ = now_s_;
  if (with_i) mode_ = m4 ? Mode::dynamic : Mode::continuous, inline_power_ = 0, inline_enabled_ = true;
  const auto power = words.number('S');
  if (mode_ == Mode::standard) output_ = std::clamp(power.value_or(startup_power), 0.0, 255.0);
  else {
    powered_ = true;
    inline_power_ = std::clamp(power.value_or(255), 0.0, 255.0);  // without S from memory that nothing has set
  }
  return true;
}

bool VirtualMarlin::run_m(Command& command, const Words& words, int code) {
  char text[160];
  switch (code) {
    case 3:
    case 4: return turn_on(words, code == 4);
    case 5:
      if (!drained()) return false;
      output_ = 0;
      if (mode_ != Mode::standard) inline_enabled_ = false;
      if (mode_ != Mode::standard && words.has('I')) mode_ = Mode::standard, inline_power_ = 0;
      return true;
    case 400: return drained();
    case 410:
      if (options_.emergency_parser) return true;
      if (!command.started) command.started = true, quick_stop();
      return drained();
    case 105: output_text_ += "T:21.0 /0.0 @:0\n"; return true;
    case 114: {
      const auto& p = planned_mm_;
      std::snprintf(text, sizeof text, "X:%.2f Y:%.2f Z:%.2f E:0.00 Count X:0 Y:0 Z:0\n", p[0] - offset_mm_[0],
                    p[1] - offset_mm_[1], p[2] - offset_mm_[2]);
      output_text_ += text;
      return true;
    }
    case 115:
      output_text_ += std::string("FIRMWARE_NAME:Marlin ") + (options_.inline_modes ? "2.1.2.5" : "1.1.9") +
                      " (Jan 1 2024) SOURCE_CODE_URL:x\n";
      return true;
    case 211:
      std::snprintf(text, sizeof text, "Soft endstops: On  Min: X0.00 Y0.00 Z0.00   Max:  X%.2f Y%.2f Z%.2f\n",
                    options_.bed_mm[0], options_.bed_mm[1], options_.bed_mm[2]);
      output_text_ += text;
      return true;
    default: return true;
  }
}

void VirtualMarlin::step(double seconds) {
  double left = seconds;
  while (left > 0) {
    if (!block_) {
      if (blocks_.empty()) break;
      block_ = blocks_.front();
      blocks_.pop_front();
      if (mode_ != Mode::standard) output_ = block_->power;
    }
    double length = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
      length += (block_->to_mm[axis] - at_mm_[axis]) * (block_->to_mm[axis] - at_mm_[axis]);
    length = std::sqrt(length);
    const double reach = block_->speed_mm_per_s * left;
    moved_s_ = now_s_;
    if (reach < length) {
      for (std::size_t axis = 0; axis < 3; ++axis)
        at_mm_[axis] += (block_->to_mm[axis] - at_mm_[axis]) * reach / length;
      return;
    }
    at_mm_ = block_->to_mm;
    left -= length / block_->speed_mm_per_s;
    block_.reset();
  }
  if (block_ || !blocks_.empty()) return;
  if (mode_ == Mode::dynamic) output_ = 0;
  if (options_.safety_timeout && now_s_ - moved_s_ > safety_s) output_ = 0;
}

}  // namespace formwright
