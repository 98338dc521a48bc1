// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/bounds/barrier.h"

#include <cmath>

namespace formwright {
namespace {

constexpr double slack_kept = 0.1;     // of a slack, in one step
constexpr double force_kept = 0.005;   // of a force
constexpr double max_unbalance = 1e8;  // of s y over w: beyond it a force is reset (Waechter and Biegler 2006, eq. 16)

}  // namespace

Barrier::Barrier(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, const Eigen::VectorXd& u)
    : lower_(lower), upper_(upper), u_(u) {
  for (Eigen::Index i = 0; i < u.size(); ++i) count_ += std::isfinite(lower[i]) + std::isfinite(upper[i]);
}

void Barrier::start_forces() {
  force_lower_ = weight_ / (u_ - lower_).array();  // 0 where there is no bound
  force_upper_ = weight_ / (upper_ - u_).array();
}

Eigen::VectorXd Barrier::stiffness() const {
  return force_lower_.array() / (u_ - lower_).array() + force_upper_.array() / (upper_ - u_).array();
}

Eigen::VectorXd Barrier::gradient_at(const Eigen::VectorXd& u) const {
  return weight_ / (upper_ - u).array() - weight_ / (u - lower_).array();
}

Eigen::VectorXd Barrier::within(const Eigen::VectorXd& step) const {
  return step.cwiseMax((slack_kept - 1) * (u_ - lower_)).cwiseMin((1 - slack_kept) * (upper_ - u_));
}

void Barrier::move(const Eigen::VectorXd& way) {
  // Newton's step of the forces, as long as all of them stay positive.
  double length = 1;
  const auto change = [&](double slack, double force, double slack_change) {
    const double d = weight_ / slack - force - force / slack * slack_change;
    if (d < 0) length = std::min(length, (1 - force_kept) * force / -d);
    return d;
  };
  Eigen::VectorXd d_lower = Eigen::VectorXd::Zero(way.size()), d_upper = d_lower;
  for (Eigen::Index i = 0; i < way.size(); ++i) {
    if (std::isfinite(lower_[i])) d_lower[i] = change(u_[i] - lower_[i], force_lower_[i], way[i]);
    if (std::isfinite(upper_[i])) d_upper[i] = change(upper_[i] - u_[i], force_upper_[i], -way[i]);
  }
  force_lower_ += length * d_lower;
  force_upper_ += length * d_upper;
  u_ += way;
  const auto reset = [&](double slack, double& force) {
    force = std::clamp(force, weight_ / (max_unbalance * slack), weight_ * max_unbalance / slack);
  };
  for (Eigen::Index i = 0; i < way.size(); ++i) {
    if (std::isfinite(lower_[i])) reset(u_[i] - lower_[i], force_lower_[i]);
    if (std::isfinite(upper_[i])) reset(upper_[i] - u_[i], force_upper_[i]);
  }
}

}  // namespace formwright
