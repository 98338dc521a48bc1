// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The zipper's course: spirals in the first and the last part, Fermat spirals (one line in, one out) in those between,
// joined where the curve crosses interfaces. Thesis Sec. 5.2.3.
#include <optional>
#include <string>
#include <vector>

#include "base/context.h"
#include "zippable/curve/line_trace.h"
#include "zippable/curve/traversal.h"

namespace formwright {

struct CurveOptions {
  double width_mm = 20;               // of the ribbon, where no number of windings is given
  std::optional<double> windings;     // of every part
  std::vector<double> part_windings;  // of each on its own where above 0
  double sample_mm = 5;               // between vertices of the ribbon along the zipper, about
};

/// A line of a part from its lower line to its upper one.
struct SpiralLine {
  int part = 0;
  double x_low_mm = 0, x_high_mm = 0;
  bool upward = true;  // as the curve runs
  TracedLine trace;
  std::vector<int> samples;  // from low to high: curve samples; the first and the last are the line's ends
  std::vector<int> grid;     // per sample: x is grid * the part's grid step; no_grid at the ends
};
inline constexpr int no_grid = -1'000'000'000;

struct CurveSample {
  Vec3 position_mm;
  int line = 0;  // a sample on an interface belongs to the line before it
};

struct ZipperCurve {
  std::vector<SpiralLine> lines;         // in the order of the curve
  std::vector<CurveSample> samples;      // in the order of the curve
  std::vector<std::vector<int>> pieces;  // from opening to opening: samples
  std::vector<double> windings;          // per part, as drawn
  std::vector<int> grid_count;           // per part: steps in a period
  std::vector<double> grid_step_mm;      // per part, of x
  std::vector<std::string> notes;
  int fermat_spirals = 0;
  double length_mm = 0;  // of the traced polylines on the surface
};

/// Where the curve's lines run in the parameter domain, in the order of the curve, untraced; `curve` gets windings,
/// notes and Fermat spirals.
std::vector<SpiralLine> place_lines(const Segmentation& segmentation, const Parameterisation& parameterisation,
                                    const Traversal& traversal, const Crossings& crossings, const CurveOptions& options,
                                    ZipperCurve& curve);

/// A full turn at least is drawn in the first and the last part and three quarters in the others.
/// Throws Error: invalid_input ("mesh": no traversal), cancelled.
ZipperCurve draw_zipper_curve(const Segmentation& segmentation, const Parameterisation& parameterisation,
                              const LineTracer& tracer, const Traversal& traversal, const Crossings& crossings,
                              const CurveOptions& options, Context& context);

/// Of grid places along something that is `local_mm[i]` long between i and i + 1 (the first is number `first`), those
/// to use so that they are not much closer than `sample_mm`: all multiples of a power of two, the same wherever lengths
/// are alike.
std::vector<int> thinned_grid(int first, const std::vector<double>& local_mm, double sample_mm, int maximum);

}  // namespace formwright
