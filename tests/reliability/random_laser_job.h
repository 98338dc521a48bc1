// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Random jobs for a GRBL laser, and where a person who reads one would expect it to burn.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

#include "base/random.h"
#include "machines/gcode/gcode_words.h"
#include "machines/virtual_grbl/virtual_grbl.h"

namespace formwright::reliability_test {

using Point = VirtualGrbl::Point;

struct Stroke {
  Point from, to;
};
struct Job {
  std::string text;
  std::vector<Stroke> strokes;  // of what burns, from the origin
  std::vector<Point> places;    // all it goes to
};

/// Reads a job as a person would: G0 and G1 with X and Y, M3, M4, M5, S.
inline void trace(Job& job) {
  Point at{0, 0, 0};
  bool on = false;
  int motion = 0;
  double power = 0;
  for (std::size_t begin = 0; begin < job.text.size();) {
    const std::size_t end = std::min(job.text.find('\n', begin), job.text.size());
    const std::string line = job.text.substr(begin, end - begin);
    begin = end + 1;
    Point to = at;
    bool moves = false;
    std::vector<GcodeWord> words;
    read_gcode_words(line, false, words);
    for (const auto& [letter, value, has_number] : words) {
      if (letter == 'X') to[0] = value, moves = true;
      if (letter == 'Y') to[1] = value, moves = true;
      if (letter == 'S') power = value;
      if (letter == 'G' && value <= 1) motion = static_cast<int>(value);
      if (letter == 'M') on = value == 3 || value == 4 || (on && value != 5 && value != 2);
    }
    if (!moves) continue;
    job.places.push_back(to);
    if (on && motion == 1 && power > 0) job.strokes.push_back({at, to});
    at = to;
  }
}

inline Job random_job(Random& random) {
  Job job;
  const auto add = [&](const char* format, auto... values) {
    if constexpr (sizeof...(values) == 0) {
      job.text += format;
    } else {
      char line[80];
      std::snprintf(line, sizeof line, format, values...);
      job.text += line;
    }
  };
  const bool constant = random.uniform() < 0.3, starts_at_zero = random.uniform() < 0.2;
  add("G21\nG90\nM%dS%d\n", constant ? 3 : 4, 200 + static_cast<int>(random.below(600)));
  if (random.uniform() < 0.9) add("G0X0Y0\n");
  if (!starts_at_zero) add("G0X%.3fY%.3f\n", random.uniform(0, 60), random.uniform(0, 60));
  add("G1F%d\n", 1500 + 500 * static_cast<int>(random.below(10)));
  if (random.uniform() < 0.05) add("G64\n");  // GRBL refuses it, so the driver takes no such job
  for (std::size_t i = 5 + random.below(50); i > 0; --i) {
    add("G%dX%.3fY%.3f\n", random.uniform() < 0.7 ? 1 : 0, random.uniform(0, 60), random.uniform(0, 60));
    if (random.uniform() < 0.05) add("S%d\n", 100 + static_cast<int>(random.below(800)));
    if (!constant && random.uniform() < 0.02) add("G4P0.2\n");  // with M3 it would burn at rest, which is confirmed
  }
  const double ending = random.uniform();
  if (ending < 0.4) add("M5\nG0X0Y0\nM2\n");
  else if (ending < 0.6) add("M5\n");
  else if (ending < 0.8) job.text.resize(job.text.size() / 2 + random.below(job.text.size() / 2));  // cut short
  trace(job);
  return job;
}

inline double distance_mm(const Point& p, const Stroke& stroke) {
  const double dx = stroke.to[0] - stroke.from[0], dy = stroke.to[1] - stroke.from[1], length = dx * dx + dy * dy;
  const double along = ((p[0] - stroke.from[0]) * dx + (p[1] - stroke.from[1]) * dy) / (length > 0 ? length : 1);
  const double t = std::clamp(along, 0.0, 1.0);
  return std::hypot(p[0] - stroke.from[0] - t * dx, p[1] - stroke.from[1] - t * dy);
}

}  // namespace formwright::reliability_test
