// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/ribbon_boundary.h"

#include <algorithm>
#include <cmath>

namespace formwright {

RibbonBoundary::RibbonBoundary(int part_count, const Parameterisation& p, const LineTracer& tracer, const ZipperCurve& curve,
                               double sample_mm)
    : tracer_(tracer), curve_(curve), sample_mm_(sample_mm), left_place_(curve.samples.size(), -1), right_place_(curve.samples.size(), -1) {
  // Strips of each part: lines in the order of x, then the first again, a period on.
  std::vector<std::vector<int>> lines_of(part_count);
  for (int l = 0; l < static_cast<int>(curve.lines.size()); ++l) lines_of[curve.lines[l].part].push_back(l);
  std::vector<int> strip_left_of(curve.lines.size()), strip_right_of(curve.lines.size());
  for (int part = 0; part < part_count; ++part) {
    const auto& lines = lines_of[part];
    for (std::size_t k = 0; k < lines.size(); ++k) {
      const bool around = k + 1 == lines.size();
      Strip strip{lines[k], lines[around ? 0 : k + 1], around ? curve.grid_count[part] : 0, around ? p.period_mm[part] : 0.0, {}, {}};
      strip_right_of[strip.left_line] = strip_left_of[strip.right_line] = static_cast<int>(strips.size());
      strips.push_back(std::move(strip));
    }
  }
  const auto upper_end = [&](int l) { return curve.lines[l].x_high_mm; };
  // With the surface to the left, upper lines are walked towards smaller x: over the strip on the left of where the line ends.
  const auto add_upper = [&](int line) {
    Strip& strip = strips[strip_left_of[line]];
    add_opening(curve.lines[line].part, true, upper_end(line) + strip.right_offset_mm, upper_end(strip.left_line), &strip.upper);
  };
  const std::size_t pieces = curve.pieces.size();
  for (std::size_t k = 0; k < pieces; ++k) {
    add_piece(k, true);
    int last_line = curve.samples[curve.pieces[k].back()].line;
    add_upper(last_line);
  }
  for (std::size_t k = pieces; k-- > 0;) {
    add_piece(k, false);
    const int first_line = curve.samples[curve.pieces[k].front()].line;
    if (part_count == 1) {
      Strip& strip = strips[0];
      add_opening(0, false, curve.lines[0].x_low_mm, curve.lines[0].x_low_mm + p.period_mm[0], &strip.lower);
    } else {
      add_upper(first_line);
    }
  }
}

void RibbonBoundary::add_piece(std::size_t piece, bool left) {
  const std::vector<int>& samples = curve_.pieces[piece];
  const std::size_t count = samples.size();
  for (std::size_t k = 0; k < count; ++k) {
    const int sample = samples[left ? k : count - 1 - k];
    (left ? left_place_ : right_place_)[sample] = static_cast<int>(vertices.size());
    vertices.push_back({curve_.samples[sample].position_mm, sample, static_cast<int>(piece), left});
  }
}

void RibbonBoundary::add_opening(int part, bool upper, double x_from, double x_to, std::vector<std::pair<int, int>>* places) {
  ++opening_arcs;
  const double step = curve_.grid_step_mm[part];
  const double low = std::min(x_from, x_to), high = std::max(x_from, x_to);
  const int first = static_cast<int>(std::ceil(low / step + 0.3)), last = static_cast<int>(std::floor(high / step - 0.3));
  std::vector<double> local;
  for (int i = first; i <= last; ++i)
    local.push_back((tracer_.on_line(part, upper, (i + 0.5) * step) - tracer_.on_line(part, upper, (i - 0.5) * step)).norm());
  std::vector<int> grid = thinned_grid(first, local, sample_mm_, 8);
  if (x_to < x_from) std::reverse(grid.begin(), grid.end());
  for (const int i : grid) {
    places->emplace_back(i, static_cast<int>(vertices.size()));
    vertices.push_back({tracer_.on_line(part, upper, i * step), -1, -1, true});
  }
}

int RibbonBoundary::place(int line, std::size_t sample, bool larger_x) const {
  const SpiralLine& l = curve_.lines[line];
  // Going up towards larger x, what lies below the line is on the right.
  const bool left = larger_x != l.upward;
  return (left ? left_place_ : right_place_)[l.samples[sample]];
}

}  // namespace formwright
