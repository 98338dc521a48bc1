// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Bundle adjustment [TMHF00]: cameras, lenses, the strips of the board and the points of the sheet that together
// explain best where everything was seen, and how sure each point is.
#include <array>
#include <vector>

#include "base/context.h"
#include "evidence/photographs/camera.h"

namespace formwright {

/// Where a strip lies against where it should: x' = turned by turn_rad about its nominal origin, then shifted.
struct StripPlace {
  Vec2 shift_mm{0, 0};
  double turn_rad = 0;
  static constexpr int unknowns = 3;
};

struct BundleCamera {
  int lens = 0;
  Pose pose;
};

/// A corner of a mark, seen in one photograph. Either on a strip or a point of the sheet.
struct BundleObservation {
  int camera = 0;
  int strip = -1;             // 0 to 3, or -1
  int point = -1;             // of the sheet, or -1
  Vec2 from_origin_mm{0, 0};  // on a strip: from its origin, in the machine's axes
  Vec2 picture_px{0, 0};
  Eigen::Matrix2d covariance_px2 = Eigen::Matrix2d::Identity();
  double shared_px = 0;  // of its error, that other photographs of the same point have alike; not used here
  bool used = true;      // false: an outlier
};

/// The board's plane is horizontal. The frame is the machine's: strips are on the mean where they should be, without
/// shift or turn of all together.
struct Bundle {
  std::vector<Lens> lenses;
  std::vector<BundleCamera> cameras;
  std::array<Vec2, 4> strip_origin_mm{};
  std::array<StripPlace, 4> strips{};
  double board_z_mm = 0;
  std::vector<Vec3> points;
  std::vector<BundleObservation> observations;

  /// A weak assumption about lenses of cameras: standard deviations.
  double centre_prior = 0.01;  // of the principal point from the picture's middle, in longer sides; 0: no prior
  double k_prior = 0.5;        // of k1 and k2 from 0; 0: no prior

  Vec3 place_mm(const BundleObservation& o) const;
};

struct BundleFit {
  double noise = 1;   // the observations' standard deviations are to be multiplied by this
  double rms_px = 0;  // of what is left, used observations
  int iterations = 0;
  bool converged = false;
  std::vector<Eigen::Matrix3d> covariance_mm2;  // per point, of the cameras' and its own uncertainty; only where asked
};

/// Levenberg-Marquardt over everything at once; the points are eliminated first (Schur complement). `robust`: distances
/// far beyond the usual one count little (Cauchy's loss, its scale from the median). `with_covariance`: from the normal
/// equations at the end, times noise^2.
/// Needs every point in two used observations, every camera in three. Throws Error: could_not_solve (singular, or not
/// finite), cancelled.
BundleFit adjust_bundle(Bundle& bundle, bool robust, bool with_covariance, int max_iterations, const Context& context);

/// What is left of an observation, in its own standard deviations; a large number where the point is not seen at all.
double whitened_distance(const Bundle& bundle, const BundleObservation& o);

}  // namespace formwright
