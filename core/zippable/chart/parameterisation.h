// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The seamless parameterisation of all parts, thesis Sec. 5.2.2, eq. (5.1) to (5.5): the least symmetric Dirichlet
// energy under the constraints, by projected Newton steps (Shtengel et al. 2017; Teran et al. 2005) from Tutte's
// embedding.
#include <vector>

#include "base/context.h"
#include "zippable/chart/seamless_chart.h"

namespace formwright {

struct ParameterisationOptions {
  /// Stops when a step would lower the energy by less than this share.
  double tolerance = 1e-6;
  int iterations_max = 300;
};

struct Parameterisation {
  /// Per corner, mm: x along the lines, y from the lower line (0) to the upper one (the height). Continuous over all
  /// faces of a part but for its cut, where x jumps by the period.
  CornerCoordinates corners_mm;
  std::vector<double> period_mm, height_mm;  // per part
  std::vector<double> interface_length_mm;   // per interface
  std::vector<double> face_distortion;       // symmetric Dirichlet energy over 4: 1 for an isometry
  double distortion_mean = 0;                // weighted by area
  double distortion_max = 0;
  double energy_start = 0;  // mean energy over 4 of the embedding that the iteration began with
  int iterations = 0;
  int true_hessians = 0;  // steps taken with the unprojected Hessian
  double decrement = 0;   // of the last step: twice the energy that was left to gain
  double seconds_start = 0, seconds_newton = 0;
};

/// Needs a valid segmentation. Throws Error: invalid_input (not valid: names the part), could_not_solve ("mesh": the
/// start is not an embedding, or the iteration does not settle), cancelled.
Parameterisation parameterise(const Segmentation& segmentation, const ParameterisationOptions& options,
                              Context& context);

/// Largest violation of (5.2) to (5.4) in mm, recomputed from corners alone: seams, straight lines, interfaces.
double constraint_residual_mm(const Segmentation& segmentation, const Parameterisation& parameterisation);

}  // namespace formwright
