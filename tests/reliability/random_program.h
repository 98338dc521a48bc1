// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Random programs of G-code: good ones, and ones with a line that must be refused.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "base/random.h"

namespace formwright {

/// Writes good programs, with a line among them that must be refused where it is asked to.
class Author {
 public:
  Author(Random& random, bool marlin) : random_(random), marlin_(marlin) {}

  std::string program(bool hostile) {
    text_ = random_.below(3) == 0 ? "%\n(a program; of nobody)\n" : "";
    if (random_.below(4) != 0) say("G21"), say("G90");
    const std::size_t count = 4 + random_.below(40), bad = random_.below(count);
    feed_ = false;
    for (std::size_t n = 0; n < count; ++n) {
      if (hostile && n == bad) say(hostile_line());
      else line();
    }
    say("M5");
    if (random_.below(2) == 0) say(marlin_ ? "G0 X0 Y0" : "M2");
    return text_;
  }

 private:
  bool chance(std::size_t one_in) { return random_.below(one_in) == 0; }

  std::string number(double value) {
    char text[40];
    // In inches with two decimals more, so that arcs close.
    std::snprintf(text, sizeof text, inches_ ? "%.6f" : "%.4f", value);
    return text;
  }

  void say(const std::string& words) {
    std::string line = words;
    if (!marlin_ && chance(8)) line = "N" + std::to_string(random_.below(9999)) + " " + line;
    if (chance(10)) std::transform(line.begin(), line.end(), line.begin(), [](char c) { return std::tolower(c); });
    if (chance(12)) line += chance(2) ? " ; so" : " (so)";
    text_ += line + (chance(20) ? "\n\n" : "\n");
  }

  double place() { return random_.uniform(-40, 40) / (inches_ ? 25.4 : 1); }

  std::string feed() {
    if (feed_ && !chance(4)) return "";
    feed_ = true;
    return " F" + std::to_string(100 + random_.below(2000));
  }

  void line() {
    switch (random_.below(marlin_ ? 9 : 14)) {
      case 0: return say("M" + std::to_string(3 + random_.below(3)) + (chance(2) ? " S100" : ""));
      case 1: return say(chance(2) ? "M8" : "M9");
      case 2: return say(marlin_ ? "G4 P10" : "G4P0.01");
      case 3: return say("G90"), void(relative_ = false);
      case 4: return say("G91"), void(relative_ = true);
      case 9: return say("G" + std::to_string(plane_ = static_cast<int>(17 + random_.below(3))));
      case 10:
        inches_ = chance(2);
        feed_ = false;
        return say(inches_ ? "G20" : "G21");
      case 11: return say(chance(2) ? "G40 G49 G94" : "G54 G61 G91.1");
      case 5:
      case 6:
      case 12: return arc();
      default: return straight();
    }
  }

  void straight() {
    const bool works = chance(2);
    std::string words;
    for (const char axis : std::string("XYZ"))
      if (chance(2)) words += std::string(chance(2) ? " " : "") + axis + number(place());
    if (words.empty()) words = "X" + number(place());
    const std::string command = works ? "G1" + feed() : "G0";
    // A modal line repeats the motion of the last straight one.
    const bool modal = !marlin_ && last_ == (works ? "G1" : "G0") && feed_ && chance(2);
    last_ = works ? "G1" : "G0";
    say((modal ? "" : command + " ") + words);
  }

  /// By its centre, from wherever it begins to a place that is turned about it, so that its ends fit; or by its radius.
  void arc() {
    last_ = "";
    const std::size_t first = plane_ == 17   ? 0
                              : plane_ == 18 ? 2
                                             : 1,
                      second = (first + 1) % 3, third = (first + 2) % 3;
    const double i = place() / 2, j = place() / 2, angle = random_.uniform(-3.1, 3.1);
    const double dx = i - i * std::cos(angle) + j * std::sin(angle), dy = j - i * std::sin(angle) - j * std::cos(angle);
    const bool left = chance(2), whole = chance(5), by_radius = !whole && chance(2);
    const auto word = [](char letter, const std::string& value) { return std::string(1, letter) + value; };
    // Ends are given as offsets: only then do they fit without knowing where the arc begins.
    if (!relative_) say("G91");
    std::string words = left ? "G3" : "G2";
    words += feed();
    if (!whole) words += " " + word("XYZ"[first], number(dx)) + " " + word("XYZ"[second], number(dy));
    else if (!marlin_) words += " " + word("XYZ"[first], "0") + " " + word("XYZ"[second], "0");
    if (chance(3)) words += " " + word("XYZ"[third], number(place()));
    if (by_radius) {
      const double radius = std::hypot(i, j), half = std::hypot(dx, dy) / 2;
      words += " R" + number((chance(2) ? 1 : -1) * std::max(radius, half + 1e-3));
    } else {
      words += " " + word("IJK"[first], number(i)) + " " + word("IJK"[second], number(j));
      if (marlin_ && chance(6)) words += " P1";
    }
    say(words);
    if (!relative_) say("G90");
  }

  std::string hostile_line() {
    static const std::vector<std::string> grbl = {"G53 G0 X1",
                                                  "G28",
                                                  "G30 Z1",
                                                  "G28.1",
                                                  "G55",
                                                  "G59.1",
                                                  "G92 X0",
                                                  "G92.1",
                                                  "G10 L2 P1 X3",
                                                  "G10 L20 P0 Z0",
                                                  "G52 Y2",
                                                  "G43.1 Z2",
                                                  "G43 H1",
                                                  "G81 X1 Y1 Z-2 R1 F50",
                                                  "M98 P1",
                                                  "O100 sub",
                                                  "G1 X#3 F10",
                                                  "G1 X[2*3] F10",
                                                  "#1=3",
                                                  "G64",
                                                  "T1 M6",
                                                  "G93",
                                                  "G38.2 Z-1 F10",
                                                  "G2 X5 Y5 F10",
                                                  "G2 X1 Y90 Z80 R1 F10",
                                                  "G3 X50 Y30 Z40 I1 J1 K1 F10",
                                                  "G1 G0 X1 F10",
                                                  "X1 X2",
                                                  "G1 A5 F10",
                                                  "G0 X9000000",
                                                  "G90.1",
                                                  "G41 D1",
                                                  "M7 M8",
                                                  "G4",
                                                  "G0 X1 I2",
                                                  "G1 X1 F-3",
                                                  "G5 X1 I1 J1",
                                                  "/G0 X1",
                                                  "$H",
                                                  "G0 X1 !",
                                                  "G17 G18"};
    static const std::vector<std::string> marlin = {
        "G28 X",   "G20",         "G18", "G92 X0", "G90 G0 X1",         "X5",      "G29",     "T1",
        "M428",    "M23 job.gco", "G53", "G27",    "G5 X1 I1 J1 P1 Q1", "M206 X5", "M92 X80", "G1 X#3",
        "M32 a.g", "M600"};
    const auto& lines = marlin_ ? marlin : grbl;
    return lines[random_.below(lines.size())];
  }

  Random& random_;
  const bool marlin_;
  std::string text_, last_;
  int plane_ = 17;
  bool inches_ = false, relative_ = false, feed_ = false;
};

}  // namespace formwright
