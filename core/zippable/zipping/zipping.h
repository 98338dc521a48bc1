// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// "Will it zip?": the flat ribbon as nearly inextensible cloth, its seams drawn together one after the other as a
// slider passes them, until it comes to rest. The design's shape is not used on the way, only compared with at the end.
#include <optional>
#include <tuple>
#include <vector>

#include "base/context.h"
#include "base/parameters.h"
#include "zippable/zipping/shape_comparison.h"
#include "zippable/zipping/zipping_system.h"

namespace formwright {

namespace unit {
inline constexpr Unit newton_per_mm{"N/mm"}, newton_mm{"N mm"};
}

struct ZippingOptions {
  double thickness_mm = 0.5;
  double stretch_n_per_mm = 10;
  std::optional<double> bending_n_mm;
  double stuffing_pressure_pa = 0;
  std::optional<double> hold_open_percent;
  double press_out_percent = 300;
  double edge_mm = 0;
  int steps = 300;
  int seed = 1;
  int frames = 40;
  double tolerance_percent = 2;

  static constexpr auto parameters = std::tuple{
      parameter("thickness_mm", &ZippingOptions::thickness_mm, "Cloth thickness", unit::mm, 0.01, 20,
                "Gives the bending stiffness where that is not given itself.")
          .slider(0.1, 3)
          .group("Cloth"),
      parameter("stretch_n_per_mm", &ZippingOptions::stretch_n_per_mm, "Stretch stiffness", unit::newton_per_mm, 0.01,
                1e5, "Force to stretch a strip 1 mm wide to twice its length; cotton about 10, felt 1.")
          .slider(0.5, 100)
          .group("Cloth"),
      parameter("bending_n_mm", &ZippingOptions::bending_n_mm, "Bending stiffness", unit::newton_mm, 1e-6, 1e6,
                "Moment to bend a strip 1 mm wide to a radius of 1 mm; automatic: as if solid. Cotton about 0.01.")
          .slider(0.001, 10)
          .group("Cloth"),
      parameter("stuffing_pressure_pa", &ZippingOptions::stuffing_pressure_pa, "Stuffing", unit::pascal, 0, 1e6,
                "Pressure from inside on what is closed already.")
          .slider(0, 1000)
          .group("Cloth"),
      parameter(
          "hold_open_percent", &ZippingOptions::hold_open_percent, "Held open", unit::percent, 0, 500,
          "Zipping, what is closed is held open from inside, by a pressure of this share of stretch stiffness over size; not at the end. Automatic: 40, 0, 15, until it fits.")
          .slider(0, 100)
          .group("Simulation"),
      parameter(
          "press_out_percent", &ZippingOptions::press_out_percent, "Pressed out", unit::percent, 0, 5000,
          "Where it has not taken its shape it is pressed out from inside once, as hands do with tucked-in corners, and let go; measured as Held open. 0: never.")
          .slider(0, 1000)
          .group("Simulation"),
      parameter("edge_mm", &ZippingOptions::edge_mm, "Longest edge", unit::mm, 0, 1000,
                "Triangles with longer edges are halved, all seams alike; 0: as designed.")
          .slider(1, 20)
          .group("Simulation"),
      parameter("steps", &ZippingOptions::steps, "Steps", unit::none, 20, 20000,
                "In which the slider goes from one end to the other.")
          .slider(100, 1000)
          .group("Simulation"),
      parameter("seed", &ZippingOptions::seed, "Disturbance", unit::none, 0, 1e9,
                "Which chance disturbance of a thousandth of the width sends the flat cloth out of its plane.")
          .slider(0, 20)
          .group("Simulation")
          .advanced(),
      parameter("frames", &ZippingOptions::frames, "Frames", unit::none, 2, 500, "Of the animation.")
          .slider(10, 100)
          .group("Simulation")
          .advanced(),
      parameter("tolerance_percent", &ZippingOptions::tolerance_percent, "Tolerance", unit::percent, 0.01, 50,
                "It takes the intended shape when 95 % of it are no farther off, in percent of its size.")
          .slider(0.5, 10)
          .group("Simulation")};
};

struct ZippingFrame {
  Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor> V;  // mm
  double zipped_share = 0;                                     // of the course; at 0.8 the slider has passed everything
};

struct ZippingResult {
  RibbonPattern pattern;
  Positions zipped_mm;               // turned (and mirrored) onto the prediction
  std::vector<ZippingFrame> frames;  // each turned onto the next one, the last onto the prediction
  ShapeComparison comparison;
  ZippingEnergies energies;
  ShapeComparison rest;  // of the shape in which it comes to rest when it is put into the prediction already zipped
  ZippingEnergies rest_energies;
  double gap_max_mm = 0;                   // between two places that should meet
  double gap_allowed_mm = 0;               // above which a seam counts as open
  int open_seams = 0;                      // pairs
  double strain_mean = 0, strain_max = 0;  // of lengths, by area
  int crossings = 0;                       // edges that pierce triangles
  bool settled = false;
  int attempts = 0;              // courses tried, with other pressures from inside; this is the best
  double held_open_percent = 0;  // in this one
  bool pressed_out = false;      // in this one, before it came to rest
  int newton_iterations = 0;
  double seconds = 0;

  bool closed() const { return open_seams == 0; }
};

/// as_the_cloth_does: farther off than the tolerance, but no farther than the same cloth sags that was put into the
/// shape.
enum class ZippingOutcome { takes_shape, as_the_cloth_does, another_shape, open_seams, not_settled };

ZippingOutcome zipping_outcome(const ZippingResult& result, double tolerance_percent);

/// Where the maker leaves open how much is held open while zipping, courses are tried until one ends in the intended
/// shape: whether it zips is whether hands can make it so. Else the best: closed, then nearest. Throws Error:
/// invalid_input ("design": see make_ribbon_pattern), could_not_solve, cancelled.
ZippingResult simulate_zipping(const RibbonDesign& design, const ZippingOptions& options, Context& context);

}  // namespace formwright
