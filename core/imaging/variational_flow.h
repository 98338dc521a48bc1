// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Where every point of one picture lies in another, by variational optical flow: Brox, Bruhn, Papenberg, Weickert 2004,
// "High Accuracy Optical Flow Estimation Based on a Theory for Warping", for pictures of three channels with weights.
//
// E(w) = integral of Psi(sum over channels of |I2(x + w) - I1(x)|^2 + gamma |grad I2(x + w) - grad I1(x)|^2) + alpha
// Psi(|grad u|^2 + |grad v|^2), Psi(s^2) = sqrt(s^2 + epsilon^2), grey levels from 0 to 255, lengths in pixels.
#include <tuple>
#include <vector>

#include "base/context.h"
#include "base/parameters.h"
#include "imaging/weighted_picture.h"

namespace formwright {

struct VariationalFlowOptions {
  double smoothness = 20;        // alpha
  double gradient_weight = 5;    // gamma
  double pyramid_factor = 0.95;  // eta: of each level's side to the next finer one's
  double fine_pyramid_factor = 0.5;
  int fine_above_px = 400;
  int fine_warps = 2;
  int inner_iterations = 2;
  int sweeps = 5;
  double data_epsilon = 2;
  double smoothness_epsilon = 0.03;

  static constexpr auto parameters =
      std::tuple{parameter("smoothness", &VariationalFlowOptions::smoothness, "Smoothness", unit::none, 0.01, 10000,
                           "Weight of a smooth displacement against equal colours (alpha).")
                     .group("Flow")
                     .slider(5, 100),
                 parameter("gradient_weight", &VariationalFlowOptions::gradient_weight, "Gradient weight", unit::none,
                           0, 1000, "Weight of equal edges against equal colours (gamma).")
                     .group("Flow")
                     .slider(0, 50),
                 parameter("pyramid_factor", &VariationalFlowOptions::pyramid_factor, "Pyramid factor", unit::none, 0.5,
                           0.98, "Size of each coarser picture against the finer one.")
                     .group("Flow")
                     .advanced(),
                 parameter("fine_pyramid_factor", &VariationalFlowOptions::fine_pyramid_factor, "Pyramid factor, fine",
                           unit::none, 0.5, 0.98, "The same among large pictures, where little is left to find.")
                     .group("Flow")
                     .advanced(),
                 parameter("fine_above_px", &VariationalFlowOptions::fine_above_px, "Fine above", unit::none, 16,
                           100000, "Longer side from which a picture counts as large, in pixels.")
                     .group("Flow")
                     .advanced(),
                 parameter("fine_warps", &VariationalFlowOptions::fine_warps, "Fine warps", unit::none, 1, 20,
                           "How often a large picture is warped anew; small ones are warped once each.")
                     .group("Flow")
                     .advanced(),
                 parameter("inner_iterations", &VariationalFlowOptions::inner_iterations, "Inner iterations",
                           unit::none, 1, 50, "Updates of the robust weights for each warp.")
                     .group("Flow")
                     .advanced(),
                 parameter("sweeps", &VariationalFlowOptions::sweeps, "Sweeps", unit::none, 1, 200,
                           "Over-relaxation sweeps for each of them.")
                     .group("Flow")
                     .advanced(),
                 parameter("data_epsilon", &VariationalFlowOptions::data_epsilon, "Noise", unit::none, 0.001, 100,
                           "Grey levels below which differences are squared rather than taken as they are.")
                     .group("Flow")
                     .advanced(),
                 parameter("smoothness_epsilon", &VariationalFlowOptions::smoothness_epsilon, "Bend", unit::none, 0.001,
                           10, "Changes of displacement per pixel below which they are squared.")
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

/// Both pictures of one size, at least 16 pixels either way. Where a weight is 0 only smoothness speaks. The same bits
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
