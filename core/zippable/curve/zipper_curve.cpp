// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/curve/zipper_curve.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "base/error.h"
#include "base/parallel.h"

namespace formwright {
namespace {

constexpr double min_spiral_windings = 1.0, min_fermat_windings = 0.75;

}  // namespace

std::vector<SpiralLine> place_lines(const Segmentation& s, const Parameterisation& p, const Traversal& traversal,
                                    const Crossings& crossings, const CurveOptions& options, ZipperCurve& curve) {
  std::vector<SpiralLine> lines;
  const int count = static_cast<int>(traversal.parts.size());
  const auto add = [&](int part, double low, double high, bool upward) {
    SpiralLine line;
    line.part = part, line.x_low_mm = low, line.x_high_mm = high, line.upward = upward;
    lines.push_back(std::move(line));
  };
  curve.windings.assign(s.part_count(), 0);
  for (int i = 0; i < count; ++i) {
    const int part = traversal.parts[i];
    const double period = p.period_mm[part];
    const bool fermat = i > 0 && i + 1 < count;
    const double minimum = fermat ? min_fermat_windings : min_spiral_windings;
    const double own = static_cast<std::size_t>(part) < options.part_windings.size()
                           ? options.part_windings[static_cast<std::size_t>(part)]
                           : 0;
    double windings = own > 0            ? own
                      : options.windings ? *options.windings
                                         : p.height_mm[part] / (fermat ? 2 * options.width_mm : options.width_mm);
    if (windings < minimum) {
      curve.notes.push_back("Part " + std::to_string(part + 1) + " got " + with_digits(minimum, 2) +
                            " windings instead of " + with_digits(windings, 2) +
                            ", the smallest number that makes a ribbon; it is narrower there.");
      windings = minimum;
    }
    curve.windings[part] = windings;
    if (count == 1) {
      add(part, 0, windings * period, true);
    } else if (i == 0) {
      add(part, crossings.exit_mm[i], crossings.exit_mm[i] + windings * period, false);
    } else if (!fermat) {
      add(part, crossings.entry_mm[i], crossings.entry_mm[i] + windings * period, true);
    } else {
      // Half a period apart at the opening; what is missing to that at the lower line is shared by both.
      const double misfit = crossings.exit_mm[i] - crossings.entry_mm[i] - 0.5 * period;
      const double top = crossings.entry_mm[i] + windings * period + 0.5 * misfit;
      add(part, crossings.entry_mm[i], top, true);
      add(part, crossings.exit_mm[i], top + 0.5 * period, false);
      ++curve.fermat_spirals;
    }
  }
  return lines;
}

std::vector<int> thinned_grid(int first, const std::vector<double>& local_mm, double sample_mm, int maximum) {
  std::vector<int> kept;
  for (std::size_t i = 0; i < local_mm.size(); ++i) {
    int step = 1;
    while (2 * step <= maximum && 1.5 * step * local_mm[i] < sample_mm) step *= 2;
    const int place = first + static_cast<int>(i);
    if (((place % step) + step) % step == 0) kept.push_back(place);
  }
  return kept;
}

ZipperCurve draw_zipper_curve(const Segmentation& s, const Parameterisation& p, const LineTracer& tracer,
                              const Traversal& traversal, const Crossings& crossings, const CurveOptions& options,
                              Context& context) {
  if (traversal.parts.empty())
    throw Error(ErrorCode::invalid_input, "mesh",
                "No order visits every part once: join or move parts so that they form a chain.");
  ZipperCurve curve;
  curve.lines = place_lines(s, p, traversal, crossings, options, curve);
  context.check_cancelled();
  parallel_for(curve.lines.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      curve.lines[i].trace = tracer.trace(curve.lines[i].part, curve.lines[i].x_low_mm, curve.lines[i].x_high_mm);
  });
  for (int part = 0; part < s.part_count(); ++part) {
    // A multiple of 16, so that thinning by powers of two agrees from one period to the next.
    const int count = 16 * std::max(1, static_cast<int>(std::ceil(p.period_mm[part] / options.sample_mm / 16)));
    curve.grid_count.push_back(count);
    curve.grid_step_mm.push_back(p.period_mm[part] / count);
  }
  std::vector<int> piece;
  for (std::size_t l = 0; l < curve.lines.size(); ++l) {
    SpiralLine& line = curve.lines[l];
    const double step = curve.grid_step_mm[line.part];
    const int first = static_cast<int>(std::ceil(line.x_low_mm / step + 0.3)),
              last = static_cast<int>(std::floor(line.x_high_mm / step - 0.3));
    std::vector<double> local;
    for (int i = first; i <= last; ++i)
      local.push_back((line.trace.at((i + 0.5) * step) - line.trace.at((i - 0.5) * step)).norm());
    std::vector<int> places = thinned_grid(first, local, options.sample_mm, 8);
    places.insert(places.begin(), no_grid);
    places.push_back(no_grid);
    const std::size_t count = places.size();
    line.grid = places;
    line.samples.resize(count);
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t i = line.upward ? k : count - 1 - k;
      if (k == 0 && !piece.empty()) {  // the crossing from the part before
        line.samples[i] = piece.back();
        continue;
      }
      const double x = i == 0 ? line.x_low_mm : i + 1 == count ? line.x_high_mm : places[i] * step;
      line.samples[i] = static_cast<int>(curve.samples.size());
      curve.samples.push_back({line.trace.at(x), static_cast<int>(l)});
      piece.push_back(line.samples[i]);
    }
    for (std::size_t i = 0; i + 1 < line.trace.position_mm.size(); ++i)
      curve.length_mm += (line.trace.position_mm[i + 1] - line.trace.position_mm[i]).norm();
    if (line.upward) curve.pieces.push_back(std::move(piece)), piece.clear();
  }
  return curve;
}

}  // namespace formwright
