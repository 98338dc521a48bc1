// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a finished flow says about points of the sheet, and how sure it is.
#include <span>

#include "evidence/registration/scan_registration.h"
#include "evidence/registration/scan_picture.h"

namespace formwright {

struct MatchStatistics {
  double similarity = 0;         // correlation of the pictures once matched, -1 to 1
  double residual_alike_px = 1;  // pixels over which neighbouring residuals are alike, from the correlation of those
                                 // beside each other; at least 1
};
MatchStatistics match_statistics(const WeightedPicture& first, const WeightedPicture& second, const Flow& flow);

/// A displacement between pixels, in mm of `frame` (y up); beyond the border as at the border.
Vec2 displacement_mm(const Flow& flow, const PlaneFrame& frame, const Vec2& place_mm);

/// On a regular grid over the sheet; points without evidence, outside of the scan or less certain than asked for are
/// counted and left out. `place_mm`: the scan's vertices in the frame of the sheet, as they were drawn for the flow.
///
/// A flow with membrane smoothing averages over an area of 4 pi l^2, l^2 = alpha Psi_s' / (Psi_d' J): the Green's
/// function of alpha Psi_s' Laplace - Psi_d' J. The covariance of a displacement is that of least squares over such an
/// area with the residuals' variance, times the pixels over which these are alike; what smoothing rounds off where the
/// stretch changes suddenly is added.
void add_points(ScanRegistration& result, const TriangleMesh& mesh, const TextureCoordinates& place_mm,
                const PlaneFrame& frame, const Flow& flow, const FlowEvidence& evidence,
                const CalibrationPattern& pattern, const ScanRegistrationOptions& options);

/// Turns and moves the points so that those on the clamped rim lie at clamp height: Umeyama 1991, without scale. Says
/// in notes why not, if not.
void align_by_rim(ScanRegistration& result, const CalibrationPattern& pattern, const ScanRegistrationOptions& options);

}  // namespace formwright
