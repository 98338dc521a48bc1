// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// "Will it zip?": the flat ribbon as nearly inextensible cloth, its seams drawn together one after the other as a
// slider passes them, until it comes to rest. The design's shape is not used before, only compared with at the end.
#include <optional>
#include <tuple>
#include <vector>

#include "base/context.h"
#include "base/data/parameters.h"
#include "zippable/making/making_errors.h"
#include "zippable/zipping/shape_comparison.h"
#include "zippable/zipping/zipping_system.h"

namespace formwright {

namespace unit {
inline constexpr Unit newton_per_mm{"N/mm"}, newton_mm{"N mm"}, newton_mm2{"N mm²"}, gram_per_m2{"g/m²"};
}

struct ZippingOptions : MakingErrors {
  double thickness_mm = 0.5;
  double stretch_n_per_mm = 10;
  std::optional<double> bending_n_mm;
  double zipper_bending_n_mm2 = 0;
  double stuffing_pressure_pa = 0;
  double weight_g_per_m2 = 0;
  double hung_at_mm = 0;
  std::optional<double> hold_open_percent;
  double press_out_percent = 300;
  double edge_mm = 0;
  int steps = 300;
  int seed = 1;
  int frames = 40;
  double tolerance_percent = 2;

  static constexpr auto parameters = std::tuple_cat(
      std::tuple{
          parameter(
              "thickness_mm", &ZippingOptions::thickness_mm, "Cloth thickness", unit::mm, 0.01, 20,
              "Thickness of the cloth. It sets the bending stiffness unless that is given; thicker cloth bends less.")
              .slider(0.1, 3)
              .group("Cloth"),
          parameter("stretch_n_per_mm", &ZippingOptions::stretch_n_per_mm, "Stretch stiffness", unit::newton_per_mm,
                    0.01, 1e5,
                    "Force that would stretch a strip 1 mm wide to twice its length. Cotton about 10, felt about 1.")
              .slider(0.5, 100)
              .group("Cloth"),
          parameter(
              "bending_n_mm", &ZippingOptions::bending_n_mm, "Bending stiffness", unit::newton_mm, 1e-6, 1e6,
              "Moment that bends a strip 1 mm wide to a radius of 1 mm. Cotton about 0.01. Automatic: computed from thickness and stretch stiffness as if the cloth were solid.")
              .slider(0.001, 10)
              .group("Cloth"),
          parameter("stuffing_pressure_pa", &ZippingOptions::stuffing_pressure_pa, "Stuffing pressure", unit::pascal, 0,
                    1e6, "Pressure of the stuffing on the inside of the parts that are already closed. 0: not stuffed.")
              .slider(0, 1000)
              .group("Cloth"),
          parameter(
              "zipper_bending_n_mm2", &ZippingOptions::zipper_bending_n_mm2, "Zipper's bending stiffness",
              unit::newton_mm2, 0, 1e6,
              "Bending stiffness of the closed zipper, a moment times a radius. 0: the seams bend as freely as the cloth.")
              .slider(0, 100)
              .group("Cloth")
              .advanced(),
          parameter(
              "weight_g_per_m2", &ZippingOptions::weight_g_per_m2, "Weight of the cloth", unit::gram_per_m2, 0, 1e5,
              "Weight that pulls the closed shape down while it hangs from one place of the zipper. 0: no weight.")
              .slider(0, 1000)
              .group("Cloth")
              .advanced(),
          parameter("hung_at_mm", &ZippingOptions::hung_at_mm, "Hung at", unit::mm, 0, 1e6,
                    "Where the closed shape hangs: length along the zipper from its start. Counts only with a weight.")
              .slider(0, 2000)
              .group("Cloth")
              .advanced(),
          parameter(
              "hold_open_percent", &ZippingOptions::hold_open_percent, "Held open", unit::percent, 0, 500,
              "Pressure that holds the closed part open from inside while it is zipped, in percent of stretch stiffness divided by size; it is released at the end. Automatic: tries 40, 0 and 15 until the shape is reached.")
              .slider(0, 100)
              .group("Simulation"),
          parameter(
              "press_out_percent", &ZippingOptions::press_out_percent, "Pressed out", unit::percent, 0, 5000,
              "Pressure that pushes tucked-in corners out from inside once after zipping, as hands do, in the same unit as Held open. 0: never.")
              .slider(0, 1000)
              .group("Simulation"),
          parameter(
              "edge_mm", &ZippingOptions::edge_mm, "Longest edge", unit::mm, 0, 1000,
              "Triangles with longer edges than this are split in half, for a more accurate simulation that takes longer. 0: keeps the triangles of the design.")
              .slider(1, 20)
              .group("Simulation"),
          parameter(
              "steps", &ZippingOptions::steps, "Steps", unit::none, 20, 20000,
              "Number of steps in which the slider moves from one end of the zipper to the other. More are more exact and take longer.")
              .slider(100, 1000)
              .group("Simulation"),
          parameter(
              "seed", &ZippingOptions::seed, "Random seed", unit::none, 0, 1e9,
              "Number that selects the small random bumps, a thousandth of the ribbon width high, that let the flat cloth buckle. Another number tries another course of zipping.")
              .slider(0, 20)
              .group("Simulation")
              .advanced(),
          parameter("frames", &ZippingOptions::frames, "Frames", unit::none, 2, 500,
                    "Number of pictures in the animation.")
              .slider(10, 100)
              .group("Simulation")
              .advanced(),
          parameter(
              "tolerance_percent", &ZippingOptions::tolerance_percent, "Tolerance", unit::percent, 0.01, 50,
              "Largest distance from the design, in percent of the object's size, within which 95 % of the cloth must lie to count as the intended shape.")
              .slider(0.5, 10)
              .group("Simulation")},
      inherit_parameters<ZippingOptions>(MakingErrors::parameters));
};

/// As given, or as a solid sheet of this thickness.
double bending_of(const ZippingOptions& options);

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

/// A shape in which nothing moves any more.
struct ZippedAtRest {
  Positions x;           // n x 3, mm, anywhere
  bool settled = false;  // within the rounds that are allowed
  int rounds = 0, iterations = 0;
  ZippingEnergies energies;
};

/// What the ribbon `pattern`, made as `options` say, comes to rest as when it is laid into `start` with all seams
/// closed, without the course of zipping. `pattern` is as designed. Throws Error: could_not_solve where the errors of
/// making leave a triangle without area, cancelled.
ZippedAtRest zipped_at_rest(const RibbonPattern& pattern, const ZippingOptions& options, const Positions& start,
                            Context& context);

/// as_the_cloth_does: farther off than the tolerance, but no farther than the same cloth sags that was put into the
/// shape.
enum class ZippingOutcome { takes_shape, as_the_cloth_does, another_shape, open_seams, not_settled };

ZippingOutcome zipping_outcome(const ZippingResult& result, double tolerance_percent);

/// Where the maker leaves open how much is held open while zipping, courses are tried until one ends in the intended
/// shape: whether it zips is whether hands can make it so. Else the best: closed, then nearest. Throws Error:
/// invalid_input ("design": see make_ribbon_pattern), could_not_solve, cancelled.
ZippingResult simulate_zipping(const RibbonDesign& design, const ZippingOptions& options, Context& context);

}  // namespace formwright
