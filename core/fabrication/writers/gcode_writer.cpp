// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/writers/gcode_writer.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "formats/shared/text_out.h"

namespace formwright {
namespace {

class GcodeText {
 public:
  void line(std::string_view words) {
    out_ << words << '\n';
    ++lines_;
  }
  GcodeText& word(char letter, double value) {
    char buffer[32];  // never 1e+05, which controllers do not read
    const auto end =
        std::to_chars(buffer, buffer + sizeof buffer, std::round(1e3 * value) / 1e3 + 0.0, std::chars_format::fixed)
            .ptr;
    row_ << (row_.text().empty() ? "" : " ") << letter << std::string_view(buffer, end);
    return *this;
  }
  void end_row() {
    line(row_.text());
    row_.text().clear();
  }
  GcodeText& command(std::string_view name) {
    row_ << name;
    return *this;
  }
  int lines() const { return lines_; }
  Bytes bytes() { return to_bytes(out_.text()); }

 private:
  TextOut out_, row_;
  int lines_ = 0;
};

std::string heading(const ToolMove& move) {
  std::string text = "; layer " + move.layer;
  if (!move.part.empty()) text += " part " + move.part.substr(0, 40);
  return text + " pass " + std::to_string(move.pass);
}

/// The axes that a move needs: z only where it changes.
void coordinates(GcodeText& text, const Vec3& from, const Vec3& to, const MachineOptions& machine) {
  const Vec2 p = to_controller(to.head<2>(), machine);
  if (from.head<2>() != to.head<2>() || from.z() == to.z()) text.word('X', p.x()).word('Y', p.y());
  if (from.z() != to.z()) text.word('Z', to.z());
}

/// Units, distances and plane as they are meant, and nothing on: whatever ran before.
void begin(GcodeText& text, bool marlin) {
  text.line("G21");
  text.line("G90");
  if (!marlin)
    for (const char* word : {"G17", "G94", "G54"}) text.line(word);
  text.line("M5");
}

/// The tool comes on once the first rapid has named x and y, before anything works or sinks.
class FirstMove {
 public:
  template <class TurnOn>
  void before(GcodeText& text, const Vec3& from, const Vec3& to, bool works, const MachineOptions& machine,
              const TurnOn& turn_on) {
    const bool begins = !on_ && (works || to.z() < from.z());
    if (begins && !placed_) {
      const Vec2 p = to_controller(from.head<2>(), machine);
      text.command("G0").word('X', p.x()).word('Y', p.y());
      text.end_row();
    }
    placed_ = placed_ || begins || from.head<2>() != to.head<2>();
    if (begins) turn_on();
    on_ = on_ || begins;
  }

 private:
  bool placed_ = false, on_ = false;
};

}  // namespace

Bytes write_laser_gcode(Toolpath& path, const LaserMachineOptions& machine) {
  const bool marlin = machine.controller == Controller::marlin;
  GcodeText text;
  text.line("; laser job in mm by Formwright");
  begin(text, marlin);
  const auto turn_on = [&] {
    if (marlin) text.line(machine.dynamic_power ? "M4 I" : "M3 I");
    else text.line(machine.dynamic_power ? "M4 S0" : "M3 S0");
    if (machine.air_assist) text.line("M8");
  };
  const auto travel_words = [&](double speed) {
    if (marlin) text.word('F', 60 * speed);
    else text.word('S', 0);
  };
  FirstMove first;
  std::string last_heading;
  for (ToolMove& move : path.moves) {
    first.before(text, move.points_mm[0], move.points_mm[1], move.work, machine, turn_on);
    if (move.work && heading(move) != last_heading) text.line(last_heading = heading(move));
    move.lines.assign(1, text.lines());
    for (std::size_t i = 1; i < move.points_mm.size(); ++i) {
      text.command(move.work ? "G1" : "G0");
      coordinates(text, move.points_mm[i - 1], move.points_mm[i], machine);
      if (move.work && i == 1)
        text.word('S', std::round(machine.power_max_s * move.power_percent / 100)).word('F', 60 * move.speed_mm_per_s);
      if (!move.work && (i == 1 || marlin)) travel_words(move.speed_mm_per_s);
      text.end_row();
      move.lines.push_back(text.lines());
    }
  }
  if (marlin) text.line("M5 I");
  text.line("M5");
  if (machine.air_assist) text.line("M9");
  text.line("G0 X0 Y0");
  if (!marlin) text.line("M2");
  return text.bytes();
}

Bytes write_mill_gcode(Toolpath& path, const MachineOptions& machine, double spindle_rpm, std::size_t stage) {
  const bool marlin = machine.controller == Controller::marlin;
  GcodeText text;
  text.line("; mill job in mm by Formwright");
  begin(text, marlin);
  const auto turn_on = [&] {
    text.command("M3").word('S', std::round(spindle_rpm));
    text.end_row();
  };
  const std::size_t begin_move = path.stages.empty() ? 0 : path.stages[stage].first_move,
                    end_move = stage + 1 < path.stages.size() ? path.stages[stage + 1].first_move : path.moves.size();
  FirstMove first;
  std::string last_heading;
  double feed = -1;
  for (std::size_t m = begin_move; m < end_move; ++m) {
    ToolMove& move = path.moves[m];
    if (move.work && heading(move) != last_heading) text.line(last_heading = heading(move));
    move.lines.assign(1, text.lines());
    for (std::size_t i = 1; i < move.points_mm.size(); ++i) {
      first.before(text, move.points_mm[i - 1], move.points_mm[i], move.work, machine, turn_on);
      text.command(move.work ? "G1" : "G0");
      coordinates(text, move.points_mm[i - 1], move.points_mm[i], machine);
      if ((move.work || marlin) && move.speed_mm_per_s != feed) text.word('F', 60 * (feed = move.speed_mm_per_s));
      text.end_row();
      move.lines.push_back(text.lines());
    }
  }
  text.line("M5");
  text.line("G0 X0 Y0");
  if (!marlin) text.line("M2");
  return text.bytes();
}

int line_count(ByteView text) { return static_cast<int>(std::count(text.begin(), text.end(), std::byte{'\n'})); }

}  // namespace formwright
