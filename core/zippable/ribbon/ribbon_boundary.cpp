// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/ribbon/ribbon_boundary.h"

#include <algorithm>
#include <cmath>

namespace formwright {

RibbonBoundary::RibbonBoundary(int part_count, const Parameterisation& p, const LineTracer& tracer,
                               const ZipperCurve& curve, double sample_mm, TapedCuts& cuts)
    : tracer_(tracer),
      curve_(curve),
      sample_mm_(sample_mm),
      left_place_(curve.samples.size(), -1),
      right_place_(curve.samples.size(), -1) {
  // Strips of each part: lines in the order of x, then the first again, a period on.
  std::vector<std::vector<int>> lines_of(part_count);
  for (int l = 0; l < static_cast<int>(curve.lines.size()); ++l) lines_of[curve.lines[l].part].push_back(l);
  std::vector<int> strip_left_of(curve.lines.size()), strip_right_of(curve.lines.size());
  for (int part = 0; part < part_count; ++part) {
    const auto& lines = lines_of[part];
    for (std::size_t k = 0; k < lines.size(); ++k) {
      const bool around = k + 1 == lines.size();
      Strip strip{lines[k],
                  lines[around ? 0 : k + 1],
                  around ? curve.grid_count[part] : 0,
                  around ? p.period_mm[part] : 0.0,
                  {},
                  {}};
      strip_right_of[strip.left_line] = strip_left_of[strip.right_line] = static_cast<int>(strips.size());
      strips.push_back(std::move(strip));
    }
  }
  const auto upper_end = [&](int l) { return curve.lines[l].x_high_mm; };
  // With the surface to the left, upper lines are walked towards smaller x: over the strip on the left of where the
  // line ends.
  std::vector<std::vector<std::pair<int, int>>*> ruled;  // per arc
  const auto plan_upper = [&](int line) {
    Strip& strip = strips[strip_left_of[line]];
    arcs.push_back({curve.lines[line].part, true, upper_end(line) + strip.right_offset_mm, upper_end(strip.left_line)});
    ruled.push_back(&strip.upper);
  };
  const std::size_t pieces = curve.pieces.size();
  for (std::size_t k = 0; k < pieces; ++k) plan_upper(curve.samples[curve.pieces[k].back()].line);
  for (std::size_t k = pieces; k-- > 0;) {
    if (part_count == 1) {
      arcs.push_back({0, false, curve.lines[0].x_low_mm, curve.lines[0].x_low_mm + p.period_mm[0]});
      ruled.push_back(&strips[0].lower);
    } else {
      plan_upper(curve.samples[curve.pieces[k].front()].line);
    }
  }
  for (OpeningArc& arc : arcs) {
    arc.grid = grid_along(arc);
    for (const int i : arc.grid) arc.places_mm.push_back(i * curve.grid_step_mm[arc.part]);
  }
  if (!cuts.empty()) cuts.share_places(arcs, curve.grid_step_mm, sample_mm);
  for (std::size_t k = 0; k < 2 * pieces; ++k) {
    add_piece(k < pieces ? k : 2 * pieces - 1 - k, k < pieces);
    add_opening(arcs[k], *ruled[k]);
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

std::vector<int> RibbonBoundary::grid_along(const OpeningArc& arc) const {
  const double step = curve_.grid_step_mm[arc.part];
  const double low = std::min(arc.from_mm, arc.to_mm), high = std::max(arc.from_mm, arc.to_mm);
  const int first = static_cast<int>(std::ceil(low / step + 0.3)),
            last = static_cast<int>(std::floor(high / step - 0.3));
  std::vector<double> local;
  for (int i = first; i <= last; ++i)
    local.push_back((tracer_.on_line(arc.part, arc.upper, (i + 0.5) * step) -
                     tracer_.on_line(arc.part, arc.upper, (i - 0.5) * step))
                        .norm());
  std::vector<int> grid = thinned_grid(first, local, sample_mm_, 8);
  if (arc.to_mm < arc.from_mm) std::reverse(grid.begin(), grid.end());
  return grid;
}

void RibbonBoundary::add_opening(OpeningArc& arc, std::vector<std::pair<int, int>>& ruled) {
  arc.first_vertex = static_cast<int>(vertices.size()) - 1;
  for (std::size_t k = 0; k < arc.places_mm.size(); ++k) {
    if (arc.grid[k] != no_grid) ruled.emplace_back(arc.grid[k], static_cast<int>(vertices.size()));
    vertices.push_back({tracer_.on_line(arc.part, arc.upper, arc.places_mm[k]), -1, -1, true});
  }
}

int RibbonBoundary::place(int line, std::size_t sample, bool larger_x) const {
  const SpiralLine& l = curve_.lines[line];
  // Going up towards larger x, what lies below the line is on the right.
  const bool left = larger_x != l.upward;
  return (left ? left_place_ : right_place_)[l.samples[sample]];
}

}  // namespace formwright
