// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Where a program of G-code goes, by code that shares nothing with core/machines.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <string>
#include <vector>

namespace formwright {

using Place = std::array<double, 3>;

/// Carries a program out after RS274/NGC (Kramer, Proctor and Messina 2000), straight from its text. It knows nothing
/// of refusals: what it is given must be good.
class Interpreter {
 public:
  explicit Interpreter(const Place& head_mm) : at_(head_mm) {}

  void run(const std::string& text) {
    std::string line;
    for (const char c : text + "\n") {
      if (c != '\n') line += c;
      else block(line), line.clear();
    }
  }

  /// Per axis: was it moved to a place that the program names, and between which places since?
  std::array<bool, 3> named{};
  Place low{}, high{};
  long places = 0;

 private:
  void block(const std::string& line) {
    std::map<char, std::vector<double>> words;
    for (std::size_t i = 0; i < line.size(); ++i) {
      if (line[i] == ';') break;
      if (line[i] == '(') i = line.find(')', i);
      else if (std::isalpha(static_cast<unsigned char>(line[i])) != 0) {
        std::string digits;
        while (i + 1 < line.size() && std::string("+-.0123456789 ").find(line[i + 1]) != std::string::npos)
          if (line[++i] != ' ') digits += line[i];
        const std::size_t letter = line.find_last_not_of("+-.0123456789 ", i);
        words[static_cast<char>(std::toupper(static_cast<unsigned char>(line[letter])))].push_back(
            std::atof(digits.c_str()));
      }
    }
    for (const double g : words['G']) {
      if (g <= 3) motion_ = static_cast<int>(g);
      if (g == 80) motion_ = -1;
      if (g >= 17 && g <= 19) plane_ = static_cast<int>(g);
      if (g == 20 || g == 21) unit_mm_ = g == 20 ? 25.4 : 1;
      if (g == 90 || g == 91) relative_ = g == 91;
    }
    const auto value = [&](char letter) -> const double* {
      const auto found = words.find(letter);
      return found == words.end() || found->second.empty() ? nullptr : &found->second.back();
    };
    Place to = at_;
    bool moves = false;
    std::array<bool, 3> given{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (const double* word = value("XYZ"[axis])) {
        given[axis] = moves = true;
        to[axis] = unit_mm_ * *word + (relative_ ? at_[axis] : 0);
      }
    const std::size_t first = plane_ == 17 ? 0 : plane_ == 18 ? 2 : 1, second = (first + 1) % 3;
    const double *i = value("IJK"[first]), *j = value("IJK"[second]), *r = value('R'), *turns = value('P');
    if (motion_ >= 0 && relative_)
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (given[axis]) begin_at(axis, at_[axis]);
    if (motion_ >= 2 && (moves || i != nullptr || j != nullptr)) {
      begin_at(first, at_[first]), begin_at(second, at_[second]);
      arc(to, first, second, i != nullptr ? unit_mm_ * *i : 0, j != nullptr ? unit_mm_ * *j : 0,
          r != nullptr ? unit_mm_ * *r : 0, turns != nullptr && *turns >= 1);
    }
    if (motion_ >= 0)
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (given[axis]) begin_at(axis, to[axis]);
    if (motion_ >= 0) go(to);
    for (const double m : words['M'])
      if (m == 2 || m == 30) motion_ = 1, plane_ = 17, relative_ = false;
  }

  /// Counts the axis from here on.
  void begin_at(std::size_t axis, double place) {
    if (!named[axis]) low[axis] = high[axis] = place;
    named[axis] = true;
  }

  void go(const Place& to) {
    at_ = to;
    ++places;
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (named[axis]) low[axis] = std::min(low[axis], to[axis]), high[axis] = std::max(high[axis], to[axis]);
  }

  /// Angle from one direction to another, counter-clockwise, more than 0 and at most a whole turn.
  static double turn(double ax, double ay, double bx, double by) {
    double angle = std::atan2(by, bx) - std::atan2(ay, ax);
    while (angle <= 1e-6) angle += 2 * std::numbers::pi;
    while (angle > 2 * std::numbers::pi + 1e-6) angle -= 2 * std::numbers::pi;
    return angle;
  }

  void arc(const Place& to, std::size_t first, std::size_t second, double i, double j, double r, bool whole) {
    const double dx = to[first] - at_[first], dy = to[second] - at_[second];
    const bool left = motion_ == 3;
    const auto sweep_about = [&](double ci, double cj) {
      const double angle = turn(-ci, -cj, dx - ci, dy - cj);
      return left ? angle : turn(dx - ci, dy - cj, -ci, -cj);
    };
    if (r != 0) {
      // Of the two circles of this radius the one whose arc is at most half a turn, for r > 0.
      const double half = std::hypot(dx, dy) / 2, height = std::sqrt(std::max(0.0, r * r - half * half));
      for (const double side : {1.0, -1.0}) {
        const double ci = dx / 2 - side * height * dy / (2 * half), cj = dy / 2 + side * height * dx / (2 * half);
        const bool is_short = sweep_about(ci, cj) <= std::numbers::pi;
        if (side > 0 || is_short == (r > 0)) i = ci, j = cj;
      }
    }
    const double sweep = (left ? 1 : -1) * (whole ? 2 * std::numbers::pi : sweep_about(i, j));
    const Place from = at_;
    constexpr int pieces = 8000;
    for (int piece = 1; piece < pieces; ++piece) {
      const double share = static_cast<double>(piece) / pieces, c = std::cos(share * sweep),
                   s = std::sin(share * sweep);
      Place p;
      for (std::size_t axis = 0; axis < 3; ++axis) p[axis] = from[axis] + share * (to[axis] - from[axis]);
      p[first] = from[first] + i + c * -i - s * -j;
      p[second] = from[second] + j + s * -i + c * -j;
      go(p);
    }
  }

  Place at_;
  int motion_ = 0, plane_ = 17;
  double unit_mm_ = 1;
  bool relative_ = false;
};

}  // namespace formwright
