// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/writers/egv_writer.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace formwright {
namespace {

constexpr double mm_per_step = 0.0254;

struct Steps {
  int x = 0, y = 0;
};

Steps steps_of(const Vec3& p, const MachineOptions& machine) {
  return {static_cast<int>(std::lround(p.x() / mm_per_step)),
          static_cast<int>(std::lround((machine.bed_y_mm - p.y()) / mm_per_step))};
}

std::string digits(int value, int places) {
  std::string text = std::to_string(value);
  return text.size() < static_cast<std::size_t>(places)
             ? std::string(static_cast<std::size_t>(places) - text.size(), '0') + text
             : text;
}

std::string two_bytes(double value) {
  const int whole = static_cast<int>(std::clamp(value, 0.0, 65535.0));
  return digits(whole >> 8, 3) + digits(whole & 255, 3);
}

/// Letters count to 51, three digits to 254, z is 255.
std::string distance(int steps) {
  std::string text(static_cast<std::size_t>(steps / 255), 'z');
  steps %= 255;
  if (steps >= 52) return text + digits(steps, 3);
  if (steps == 51) return text + "|z";
  if (steps > 25) text += '|';
  if (steps > 0) text += static_cast<char>('a' + (steps - 1) % 25);
  return text;
}

class Program {
 public:
  bool running() const { return running_; }
  double speed() const { return speed_; }
  Steps at() const { return at_; }

  void begin(double speed, const Steps& to) {
    text_ += "I" + egv_speed_code(speed);
    axes(to.x - at_.x, to.y - at_.y, true, std::nullopt);
    text_ += "N" + directions() + "S1E";
    running_ = true;
    speed_ = speed;
  }

  void end() {
    if (running_) text_ += "FNSE-\n";
    running_ = laser_ = false;
  }

  /// Fast, at the board's own speed.
  void jog(const Steps& to) {
    if (to.x == at_.x && to.y == at_.y) return;
    laser(false);
    const int dy = to.y - at_.y;
    // The step out of the program reverses y, so y is written reversed before it.
    if (!(up_ && y_alone()) && dy >= 0) text_ += 'L';
    if (!(!up_ && y_alone()) && dy <= 0) text_ += 'R';
    text_ += 'N';
    laser_ = false;
    axes(to.x - at_.x, dy, true, std::nullopt);
    text_ += "SE" + directions();
  }

  void idle_move(const Steps& to) {
    if (to.x == at_.x && to.y == at_.y) return;
    text_ += 'I';
    axes(to.x - at_.x, to.y - at_.y, true, std::nullopt);
    text_ += "S1P\n";
  }

  void line(const Steps& to) {
    const int width = std::abs(to.x - at_.x), height = -std::abs(to.y - at_.y);
    const int sx = at_.x < to.x ? 1 : -1, sy = at_.y < to.y ? 1 : -1;
    int error = width + height, run_x = 0, run_y = 0, count = 0;
    Steps now = at_;
    while (now.x != to.x || now.y != to.y) {
      const int twice = 2 * error;
      int dx = 0, dy = 0;
      if (twice >= height && now.x != to.x) {
        error += height;
        dx = sx;
      }
      if (twice <= width && now.y != to.y) {
        error += width;
        dy = sy;
      }
      now.x += dx;
      now.y += dy;
      if (count > 0 && (dx != run_x || dy != run_y)) {
        burn(count * run_x, count * run_y);
        count = 0;
      }
      run_x = dx;
      run_y = dy;
      ++count;
    }
    burn(count * run_x, count * run_y);
  }

  std::string take() { return std::move(text_); }

 private:
  bool x_alone() const { return x_on_ && !y_on_; }
  bool y_alone() const { return y_on_ && !x_on_; }

  void laser(bool on) {
    if (laser_ != on) text_ += on ? 'D' : 'U';
    laser_ = on;
  }

  void axes(int dx, int dy, bool always, std::optional<bool> on) {
    const auto axis = [&](int run, bool& back, bool alone, char forth_code, char back_code, bool is_x) {
      if (run == 0) return;
      if (always || !alone || back != (run < 0)) text_ += run < 0 ? back_code : forth_code;
      back = run < 0;
      x_on_ = is_x;
      y_on_ = !is_x;
      if (on) laser(*on);
      text_ += distance(std::abs(run));
    };
    axis(dx, left_, x_alone(), 'B', 'T', true);
    axis(dy, up_, y_alone(), 'R', 'L', false);
    at_.x += dx;
    at_.y += dy;
  }

  void burn(int dx, int dy) {
    if (dx == 0 && dy == 0) return;
    if (std::abs(dx) != std::abs(dy)) return axes(dx, dy, false, true);
    x_on_ = y_on_ = true;
    if (left_ != (dx < 0)) text_ += dx < 0 ? 'T' : 'B';
    left_ = dx < 0;
    if (up_ != (dy < 0)) text_ += dy < 0 ? 'L' : 'R';
    up_ = dy < 0;
    text_ += 'M';
    laser(true);
    text_ += distance(std::abs(dx));
    at_.x += dx;
    at_.y += dy;
  }

  std::string directions() {
    x_on_ = false;
    y_on_ = true;
    return std::string(left_ ? "T" : "B") + (up_ ? "L" : "R");
  }

  std::string text_;
  Steps at_;
  bool left_ = false, up_ = false, x_on_ = false, y_on_ = false, laser_ = false, running_ = false;
  double speed_ = 0;
};

}  // namespace

std::string egv_speed_code(double speed_mm_per_s) {
  // The board counts up to 65536 from the value; "C" at the end is its slow mode, a twelfth of the ticks a millisecond.
  constexpr double ticks_per_ms = 12120.0 / 12, ticks_apart = 8, diagonal_ratio = 0.261199033289;
  const double speed = std::clamp(speed_mm_per_s, 0.1, 240.0);
  const double period_ms = 1 / (speed / 25.4);
  const int step = std::min(static_cast<int>(std::floor(speed) + 1), 128);
  return "CV" + two_bytes(65536 - (ticks_per_ms * period_ms + ticks_apart)) + "1" + digits(step, 3) +
         two_bytes(diagonal_ratio * ticks_per_ms * period_ms / step) + "C";
}

Bytes write_egv(const Toolpath& path, const MachineOptions& machine) {
  Program program;
  for (const ToolMove& move : path.moves) {
    if (!move.work) continue;  // the board plans travel itself
    const Steps start = steps_of(move.points_mm.front(), machine);
    if (program.running() && program.speed() != move.speed_mm_per_s) program.end();
    if (!program.running()) program.begin(move.speed_mm_per_s, start);
    else program.jog(start);
    for (std::size_t i = 1; i < move.points_mm.size(); ++i) program.line(steps_of(move.points_mm[i], machine));
  }
  program.end();
  program.idle_move({0, 0});
  return to_bytes(
      "Document type : LHYMICRO-GL file\nFile version: 1.0.01\nCopyright: Unknown\nCreator-Software: Formwright\n\n%0%0%0%0%\n" +
      program.take());
}

}  // namespace formwright
