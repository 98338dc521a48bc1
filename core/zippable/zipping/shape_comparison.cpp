// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/zipping/shape_comparison.h"

#include <Eigen/Dense>
#include <algorithm>
#include <numeric>

namespace formwright {

RigidMotion best_motion(const Positions& from, const Positions& to, const Eigen::VectorXd& weight, bool mirrored) {
  const double total = weight.sum();
  const Vec3 centre_from = from.transpose() * weight / total, centre_to = to.transpose() * weight / total;
  const Eigen::Matrix3d moment = (to.rowwise() - centre_to.transpose()).transpose() * weight.asDiagonal() *
                                 (from.rowwise() - centre_from.transpose());
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(moment, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d turn = svd.matrixU() * svd.matrixV().transpose();
  if ((turn.determinant() < 0) != mirrored)
    turn = svd.matrixU() * Vec3(1, 1, -1).asDiagonal() * svd.matrixV().transpose();
  return {turn, centre_to - turn * centre_from};
}

ShapeComparison compare_shapes(const Positions& shape, const Positions& predicted, const Eigen::VectorXd& weight) {
  ShapeComparison best;
  double best_squared = 0;
  for (const bool mirrored : {false, true}) {
    const RigidMotion motion = best_motion(shape, predicted, weight, mirrored);
    const Eigen::VectorXd distance = (motion(shape) - predicted).rowwise().norm();
    const double squared = weight.dot(distance.cwiseAbs2());
    // A flat shape is its own mirror image: then it is not called mirrored for rounding's sake.
    if (mirrored && squared >= best_squared * (1 - 1e-9)) continue;
    best.motion = motion, best.mirrored = mirrored, best.distance_mm = distance, best_squared = squared;
  }
  best.mean_mm = weight.dot(best.distance_mm) / weight.sum();
  best.largest_mm = best.distance_mm.maxCoeff();
  std::vector<int> order(static_cast<std::size_t>(weight.size()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return best.distance_mm[a] < best.distance_mm[b]; });
  double passed = 0;
  for (const int v : order) {
    passed += weight[v];
    best.percentile_95_mm = best.distance_mm[v];
    if (passed >= 0.95 * weight.sum()) break;
  }
  return best;
}

}  // namespace formwright
