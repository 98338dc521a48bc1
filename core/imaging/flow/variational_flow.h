// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Where every point of one picture lies in another, by variational optical flow: Brox, Bruhn, Papenberg, Weickert 2004,
// "High Accuracy Optical Flow Estimation Based on a Theory for Warping", for pictures of three channels with weights.
//
// E(w) = integral of Psi(sum over channels of |I2(x + w) - I1(x)|^2 + gamma |grad I2(x + w) - grad I1(x)|^2) + alpha
// Psi(|grad u|^2 + |grad v|^2), Psi(s^2) = sqrt(s^2 + epsilon^2), grey levels from 0 to 255, lengths in pixels.
//
// In large pictures alpha grows with what the pictures differ by once warped, so that noise is averaged over a wider
// area. From the second warp of the finest picture on only the correction is smoothed.
#include <tuple>
#include <vector>

#include "base/context.h"
#include "base/data/parameters.h"
#include "imaging/picture/weighted_picture.h"

namespace formwright {

struct VariationalFlowOptions {
  double smoothness = 85;        // alpha
  double gradient_weight = 50;   // gamma
  double pyramid_factor = 0.95;  // eta: of each level's side to the next finer one's
  double fine_pyramid_factor = 0.5;
  int fine_above_px = 400;
  int fine_warps = 2;
  int inner_iterations = 2;
  int sweeps = 5;
  double data_epsilon = 2;
  double smoothness_epsilon = 0.03;

  static constexpr auto parameters = std::tuple{
      parameter(
          "smoothness", &VariationalFlowOptions::smoothness, "Smoothness", unit::none, 0.01, 10000,
          "How much a smooth displacement counts against matching colours (alpha in the optical flow). Larger values smooth more.")
          .group("Flow")
          .slider(20, 400),
      parameter(
          "gradient_weight", &VariationalFlowOptions::gradient_weight, "Gradient weight", unit::none, 0, 1000,
          "How much matching edges count against matching colours (gamma in the optical flow). Larger values tolerate uneven light better.")
          .group("Flow")
          .slider(0, 200),
      parameter(
          "pyramid_factor", &VariationalFlowOptions::pyramid_factor, "Pyramid factor", unit::none, 0.5, 0.98,
          "Size of each coarser picture relative to the next finer one, for small pictures. Closer to 1 follows large movements better and takes longer.")
          .group("Flow")
          .advanced(),
      parameter(
          "fine_pyramid_factor", &VariationalFlowOptions::fine_pyramid_factor, "Pyramid factor, large pictures",
          unit::none, 0.5, 0.98,
          "Size of each coarser picture relative to the next finer one, for pictures above the limit “Large from”. 0.5 is enough because little movement is left to find there.")
          .group("Flow")
          .advanced(),
      parameter("fine_above_px", &VariationalFlowOptions::fine_above_px, "Large from", unit::none, 16, 100000,
                "Longer side, in pixels, from which a picture counts as large and the second pyramid factor is used.")
          .group("Flow")
          .advanced(),
      parameter(
          "fine_warps", &VariationalFlowOptions::fine_warps, "Warps, large pictures", unit::none, 1, 20,
          "How often each large picture is warped again by the displacement found so far. More is more exact and slower; small pictures are warped once.")
          .group("Flow")
          .advanced(),
      parameter("inner_iterations", &VariationalFlowOptions::inner_iterations, "Inner iterations", unit::none, 1, 50,
                "How often the robust weights are updated after each warp. More is more exact and slower; 2 is usual.")
          .group("Flow")
          .advanced(),
      parameter(
          "sweeps", &VariationalFlowOptions::sweeps, "Solver sweeps", unit::none, 1, 200,
          "Sweeps of successive over-relaxation for each update of the weights. More is more exact and slower; 5 is usual.")
          .group("Flow")
          .advanced(),
      parameter(
          "data_epsilon", &VariationalFlowOptions::data_epsilon, "Colour noise", unit::none, 0.001, 100,
          "Colour difference, in grey levels, below which differences count as noise and are penalised quadratically; larger ones are penalised linearly, which tolerates outliers.")
          .group("Flow")
          .advanced(),
      parameter(
          "smoothness_epsilon", &VariationalFlowOptions::smoothness_epsilon, "Smooth change", unit::none, 0.001, 10,
          "Change of displacement per pixel below which it is penalised quadratically; larger ones are penalised linearly, which allows sharp changes.")
          .group("Flow")
          .advanced()};
};

/// Displacements in pixels: the pixel (x, y) of the first picture is seen at (x + u, y + v) of the second.
struct Flow {
  int width = 0, height = 0;
  std::vector<float> u, v;  // width * height, rows from the top

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
};

/// Both pictures of one size, at least 16 pixels a side. Where a weight is 0 only smoothness counts. The same bits
/// for any number of threads and in WebAssembly. Throws Error{invalid_input} for pictures of different or too small
/// size, Error{cancelled}.
Flow variational_flow(const WeightedPicture& first, const WeightedPicture& second,
                      const VariationalFlowOptions& options, Context& context);

/// The same from a first guess, with pictures no coarser than needed to correct it by `reach_px`.
Flow refined_flow(const WeightedPicture& first, const WeightedPicture& second, const Flow& guess, double reach_px,
                  const VariationalFlowOptions& options, Context& context);

/// What the pictures say at each pixel once they are matched: the squared change of colour along the axes and how much
/// is left.
struct FlowEvidence {
  std::vector<float> xx, xy,
      yy;  // sums over channels of products of derivatives, (grey levels / pixel)^2, times the weight
  std::vector<float> residual_squared;  // sum over channels, grey levels^2, times the weight
  std::vector<float> weight;            // of both pictures together, 0 to 1
};
FlowEvidence flow_evidence(const WeightedPicture& first, const WeightedPicture& second, const Flow& flow,
                           const Context& context);

}  // namespace formwright
