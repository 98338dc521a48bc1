// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/zipping/zipping_system.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "zippable/zipping/zipper_hinges.h"

namespace formwright {
namespace {

constexpr std::size_t grain = 256;

}  // namespace

double thread_energy_mj(const SeamThread& thread, const Vec3& difference) {
  if (thread.length_mm < 0) return 0;
  const double over = std::max(difference.norm() - thread.length_mm, 0.0);
  return 0.5 * thread.stiffness_n_per_mm * over * over;
}

Vec3 thread_gradient_n(const SeamThread& thread, const Vec3& difference, Eigen::Matrix3d* hessian) {
  const double distance = difference.norm();
  if (thread.length_mm < 0 || distance < thread.length_mm) {
    if (hessian) hessian->setZero();
    return Vec3::Zero();
  }
  // Without length there is no direction to keep, and none is needed.
  const double share = thread.length_mm > 0 ? thread.length_mm / distance : 0;
  if (hessian) {
    *hessian = thread.stiffness_n_per_mm * (1 - share) * Eigen::Matrix3d::Identity();
    if (share > 0)
      *hessian += thread.stiffness_n_per_mm * share / (distance * distance) * difference * difference.transpose();
  }
  return thread.stiffness_n_per_mm * (1 - share) * difference;
}

Positions pressure_force_n(const Triangles& F, const Positions& x, const std::vector<char>& under_pressure,
                           double pressure_mpa) {
  Positions force = Positions::Zero(x.rows(), 3);
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    if (!under_pressure[static_cast<std::size_t>(f)]) continue;
    const Vec3 a = x.row(F(f, 0)), b = x.row(F(f, 1)), c = x.row(F(f, 2));
    const Eigen::RowVector3d share = pressure_mpa / 6 * (b - a).cross(c - a).transpose();
    for (int k = 0; k < 3; ++k) force.row(F(f, k)) += share;
  }
  return force;
}

void balance(Positions& force_n, const Positions& x, const Eigen::VectorXd& area) {
  const Eigen::RowVector3d centre = area.transpose() * x / area.sum();
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  Vec3 moment = Vec3::Zero();
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    const Vec3 r = (x.row(i) - centre).transpose();
    inertia += area[i] * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
    moment += r.cross(Vec3(force_n.row(i).transpose()));
  }
  const Eigen::RowVector3d push = force_n.colwise().sum() / area.sum();
  const Vec3 turn = inertia.ldlt().solve(moment);
  for (Eigen::Index i = 0; i < x.rows(); ++i)
    force_n.row(i) -= area[i] * (push + turn.cross(Vec3((x.row(i) - centre).transpose())).transpose());
}

ZippingSystem::ZippingSystem(const RibbonPattern& pattern, const ClothMaterial& material, Context& context)
    : material_(material),
      triangles_(cloth_triangles(pattern.flat)),
      hinges_(cloth_hinges(pattern.flat, material.bending_n_mm)) {
  const int n = pattern.flat.vertex_count();
  for (std::size_t f = 0; f < pattern.cloth_change.size(); ++f) {
    triangles_[f].gradient *= pattern.cloth_change[f].inverse();
    triangles_[f].area_mm2 *= pattern.cloth_change[f].determinant();
  }
  if (material.zipper_bending_n_mm2 > 0)
    for (const ClothHinge& hinge : zipper_hinges(pattern, material.zipper_bending_n_mm2)) hinges_.push_back(hinge);
  for (const SeamPair& seam : pattern.seams) pairs_.push_back({seam.left, seam.right, seam.length_mm});
  for (const ClosurePair& closure : pattern.closures)
    pairs_.push_back({closure.left, closure.right, closure.length_mm});
  threads.resize(pairs_.size());
  outer_force_n = Positions::Zero(n, 3);
  anchor_mm = pattern.flat.V;
  area_ = Eigen::VectorXd::Zero(n);
  below_.resize(static_cast<std::size_t>(n));
  const auto couple = [&](int i, int j) {
    if (i != j) below_[static_cast<std::size_t>(std::min(i, j))].push_back(std::max(i, j));
  };
  for (const ClothTriangle& t : triangles_)
    for (std::size_t k = 0; k < 3; ++k) {
      area_[t.vertex[k]] += t.area_mm2 / 3;
      couple(t.vertex[k], t.vertex[(k + 1) % 3]);
    }
  for (const ClothHinge& hinge : hinges_) couple(hinge.vertex[2], hinge.vertex[3]);
  for (const Pair& pair : pairs_) couple(pair.left, pair.right);
  int entries = 0;
  for (auto& rows : below_) {
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    entries += 6 + 9 * static_cast<int>(rows.size());
  }
  std::vector<Eigen::Triplet<double, int>> triplets;
  triplets.reserve(static_cast<std::size_t>(entries));
  for (int j = 0; j < n; ++j)
    for (int k = 0; k < 3; ++k) {
      for (int r = k; r < 3; ++r) triplets.emplace_back(3 * j + r, 3 * j + k, 1.0);
      for (const int i : below_[static_cast<std::size_t>(j)])
        for (int r = 0; r < 3; ++r) triplets.emplace_back(3 * i + r, 3 * j + k, 1.0);
    }
  lower_.resize(3 * n, 3 * n);
  lower_.setFromTriplets(triplets.begin(), triplets.end());
  lower_.makeCompressed();
  std::fill(lower_.valuePtr(), lower_.valuePtr() + lower_.nonZeros(), 0.0);
  for (const ClothHinge& hinge : hinges_)
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j <= i; ++j)
        add_diagonal(slot(hinge.vertex[i], hinge.vertex[j]), hinge.stiffness_n_per_mm *
                                                                 hinge.weight[static_cast<Eigen::Index>(i)] *
                                                                 hinge.weight[static_cast<Eigen::Index>(j)]);
  bending_.assign(lower_.valuePtr(), lower_.valuePtr() + lower_.nonZeros());
  for (const ClothTriangle& t : triangles_)
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j <= i; ++j) triangle_slots_.push_back(slot(t.vertex[i], t.vertex[j]));
  for (const Pair& pair : pairs_)
    for (const Slot& s : {slot(pair.left, pair.left), slot(pair.right, pair.right), slot(pair.left, pair.right)})
      seam_slots_.push_back(s);
  terms_.resize(triangles_.size());
  const auto quiet = context.span(0, 0, "");
  cholesky_.analyze(lower_, {}, context);
}

ZippingSystem::Slot ZippingSystem::slot(int i, int j) const {
  const int low = std::min(i, j), high = std::max(i, j);
  if (low == high) return {low, -1, false};
  const auto& rows = below_[static_cast<std::size_t>(low)];
  return {low, static_cast<int>(std::lower_bound(rows.begin(), rows.end(), high) - rows.begin()), i < j};
}

void ZippingSystem::add_block(const Slot& s, const Eigen::Matrix3d& block) {
  double* values = lower_.valuePtr();
  for (int k = 0; k < 3; ++k) {
    double* column = values + lower_.outerIndexPtr()[3 * s.low + k];
    if (s.place < 0)
      for (int r = k; r < 3; ++r) column[r - k] += block(r, k);
    else
      for (int r = 0; r < 3; ++r) column[3 - k + 3 * s.place + r] += s.transposed ? block(k, r) : block(r, k);
  }
}

void ZippingSystem::add_diagonal(const Slot& s, double value) {
  for (int k = 0; k < 3; ++k)
    lower_.valuePtr()[lower_.outerIndexPtr()[3 * s.low + k] + (s.place < 0 ? 0 : 3 - k + 3 * s.place + k)] += value;
}

ZippingEnergies ZippingSystem::energies(const Positions& x) const {
  ZippingEnergies result;
  for (const ClothTriangle& t : triangles_) result.stretch_mj += stretch_energy_mj(t, material_, x);
  result.bending_mj = bending_energy_mj(hinges_, x);
  for (std::size_t i = 0; i < threads.size(); ++i)
    result.seam_mj += thread_energy_mj(threads[i], (x.row(pairs_[i].left) - x.row(pairs_[i].right)).transpose());
  return result;
}

double ZippingSystem::objective_mj(const Positions& x) const {
  double sum = energies(x).inner_mj() - outer_force_n.cwiseProduct(x - anchor_mm).sum();
  for (Eigen::Index i = 0; i < x.rows(); ++i)
    sum += 0.5 * anchor_n_per_mm3 * area_[i] * (x.row(i) - anchor_mm.row(i)).squaredNorm();
  return sum;
}

Positions ZippingSystem::gradient_n(const Positions& x) const {
  Positions gradient = -outer_force_n;
  for (Eigen::Index i = 0; i < x.rows(); ++i)
    gradient.row(i) += anchor_n_per_mm3 * area_[i] * (x.row(i) - anchor_mm.row(i));
  StretchTerms terms;
  for (const ClothTriangle& t : triangles_) {
    stretch_terms(t, material_, x, terms);
    for (std::size_t k = 0; k < 3; ++k) gradient.row(t.vertex[k]) += terms.gradient[k].transpose();
  }
  for (const ClothHinge& hinge : hinges_) {
    const Vec3 bent = hinge.stiffness_n_per_mm * bending_vector(hinge, x);
    for (std::size_t k = 0; k < 4; ++k)
      gradient.row(hinge.vertex[k]) += hinge.weight[static_cast<Eigen::Index>(k)] * bent.transpose();
  }
  for (std::size_t i = 0; i < threads.size(); ++i) {
    const Pair& seam = pairs_[i];
    const Vec3 g = thread_gradient_n(threads[i], (x.row(seam.left) - x.row(seam.right)).transpose(), nullptr);
    gradient.row(seam.left) += g.transpose();
    gradient.row(seam.right) -= g.transpose();
  }
  return gradient;
}

void ZippingSystem::assemble(const Positions& x, Positions& gradient, bool whole) {
  std::copy(bending_.begin(), bending_.end(), lower_.valuePtr());
  parallel_for(triangles_.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) stretch_terms(triangles_[f], material_, x, terms_[f], whole);
  });
  gradient = -outer_force_n;
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    const double pull = anchor_n_per_mm3 * area_[i];
    gradient.row(i) += pull * (x.row(i) - anchor_mm.row(i));
    add_diagonal({static_cast<int>(i), -1, false}, pull);
  }
  std::size_t s = 0;
  for (std::size_t f = 0; f < triangles_.size(); ++f)
    for (std::size_t i = 0; i < 3; ++i) {
      gradient.row(triangles_[f].vertex[i]) += terms_[f].gradient[i].transpose();
      for (std::size_t j = 0; j <= i; ++j) add_block(triangle_slots_[s++], terms_[f].block[i][j]);
    }
  for (const ClothHinge& hinge : hinges_) {
    const Vec3 bent = hinge.stiffness_n_per_mm * bending_vector(hinge, x);
    for (std::size_t k = 0; k < 4; ++k)
      gradient.row(hinge.vertex[k]) += hinge.weight[static_cast<Eigen::Index>(k)] * bent.transpose();
  }
  Eigen::Matrix3d hessian;
  for (std::size_t i = 0; i < threads.size(); ++i) {
    if (threads[i].length_mm < 0) continue;
    const Pair& seam = pairs_[i];
    const Vec3 g = thread_gradient_n(threads[i], (x.row(seam.left) - x.row(seam.right)).transpose(), &hessian);
    gradient.row(seam.left) += g.transpose();
    gradient.row(seam.right) -= g.transpose();
    add_block(seam_slots_[3 * i], hessian);
    add_block(seam_slots_[3 * i + 1], hessian);
    add_block(seam_slots_[3 * i + 2], -hessian);
  }
}

void ZippingSystem::factorize(const Positions& x, Positions& gradient, Context& context) {
  constexpr int cautious_steps = 3;
  if (whole_hessian && cautious_ == 0) {
    assemble(x, gradient, true);
    try {
      cholesky_.factorize(lower_, context);
      return;
    } catch (const Error& error) {
      if (error.code() != ErrorCode::could_not_solve) throw;
      cautious_ = cautious_steps;
    }
  }
  cautious_ = std::max(0, cautious_ - 1);
  assemble(x, gradient, false);
  cholesky_.factorize(lower_, context);
}

ZippingSystem::Progress ZippingSystem::minimise(Positions& x, int iterations_max, double decrement_mj,
                                                Context& context) {
  Progress progress;
  Positions gradient(x.rows(), 3), trial(x.rows(), 3);
  Eigen::VectorXd step(3 * x.rows());
  double objective = objective_mj(x);
  const auto quiet = context.span(0, 0, "");
  while (progress.iterations < iterations_max) {
    context.check_cancelled();
    factorize(x, gradient, context);
    step = -Eigen::Map<const Eigen::VectorXd>(gradient.data(), gradient.size());
    Eigen::MatrixXd columns = step;
    cholesky_.solve(columns);
    const double slope = -step.dot(columns.col(0));
    ++progress.iterations, ++iterations_;
    progress.decrement_mj = -slope;
    if (!(-slope > decrement_mj)) {
      progress.settled = true;
      break;
    }
    const Eigen::Map<const Positions> move(columns.data(), x.rows(), 3);
    bool lower = false;
    for (double share = 1; share > 1e-4 && !lower; share *= 0.5) {
      trial = x + share * move;
      const double value = objective_mj(trial);
      // Written so that a value that is not a number is refused.
      if (!(value <= objective + 1e-4 * share * slope)) continue;
      lower = true;
      objective = value;
      x = trial;
    }
    if (!lower) break;  // rounding is all that is left
  }
  return progress;
}

}  // namespace formwright
