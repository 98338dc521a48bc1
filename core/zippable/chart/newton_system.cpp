// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/chart/newton_system.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"

namespace formwright {
namespace {

const ChartCoordinate& coordinate(const SeamlessChart& chart, int face, int i) {
  return chart.coordinate(3 * face + i / 2, i % 2);
}

}  // namespace

NewtonSystem::NewtonSystem(const SeamlessChart& chart, Context& context) : chart_(chart) {
  const int n = chart.local_count(), m = chart.face_count();
  std::vector<std::vector<int>> below(n);
  for (auto& column : below) column.reserve(16);
  for (int f = 0; f < m; ++f)
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) {
        const int a = coordinate(chart, f, i).local, b = coordinate(chart, f, j).local;
        if (a >= 0 && b >= 0 && a >= b) below[b].push_back(a);
      }
  lower_.resize(n, n);
  std::size_t entries = 0;
  for (int j = 0; j < n; ++j) {
    std::sort(below[j].begin(), below[j].end());
    below[j].erase(std::unique(below[j].begin(), below[j].end()), below[j].end());
    entries += below[j].size();
  }
  lower_.resizeNonZeros(static_cast<Eigen::Index>(entries));
  int* outer = lower_.outerIndexPtr();
  int* inner = lower_.innerIndexPtr();
  outer[0] = 0;
  for (int j = 0; j < n; ++j) {
    std::copy(below[j].begin(), below[j].end(), inner + outer[j]);
    outer[j + 1] = outer[j] + static_cast<int>(below[j].size());
  }
  slot_.assign(static_cast<std::size_t>(m) * 36, -1);
  for (int f = 0; f < m; ++f) {
    bool shared = false;
    for (int i = 0; i < 6; ++i) {
      const int a = coordinate(chart, f, i).local;
      shared |= coordinate(chart, f, i).terms != 0;
      for (int j = 0; j < 6 && a >= 0; ++j) {
        const int b = coordinate(chart, f, j).local;
        if (b < 0 || a < b) continue;
        const int* place = std::lower_bound(inner + outer[b], inner + outer[b + 1], a);
        slot_[static_cast<std::size_t>(f) * 36 + i * 6 + j] = static_cast<int>(place - inner);
      }
    }
    if (shared) bordered_.push_back(f);
  }
  terms_.resize(m);
  held_.assign(n, 0);
  std::fill(lower_.valuePtr(), lower_.valuePtr() + entries, 1.0);
  const auto span = context.span(0, ordering_share, "Ordering");
  cholesky_.analyze(lower_, Positions(), context);
}

void NewtonSystem::assemble(const TriangleTerms& terms) {
  const int n = chart_.local_count(), k = chart_.shared_count();
  parallel_for(terms_.size(), 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) terms_[f] = terms(static_cast<int>(f));
  });
  energy_ = 0;
  gradient_ = Eigen::VectorXd::Zero(n);
  gradient_shared_ = Eigen::VectorXd::Zero(k);
  border_ = Eigen::MatrixXd::Zero(n, k);
  corner_ = Eigen::MatrixXd::Zero(k, k);
  std::fill(held_.begin(), held_.end(), 0);
  shared_held_ = any_held_ = false;
  double* value = lower_.valuePtr();
  std::fill(value, value + lower_.nonZeros(), 0.0);
  for (std::size_t f = 0; f < terms_.size(); ++f) {
    const DirichletTerms& t = terms_[f];
    energy_ += t.energy;
    const int* slot = &slot_[f * 36];
    double sign[6];
    for (int i = 0; i < 6; ++i) {
      const ChartCoordinate& c = coordinate(chart_, static_cast<int>(f), i);
      sign[i] = c.sign;
      if (c.local >= 0) gradient_[c.local] += c.sign * t.gradient[i];
    }
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j)
        if (slot[i * 6 + j] >= 0) value[slot[i * 6 + j]] += sign[i] * sign[j] * t.hessian(i, j);
  }
  for (const int f : bordered_) {
    const DirichletTerms& t = terms_[f];
    for (int j = 0; j < 6; ++j) {
      for (const SharedTerm& term : chart_.sum(coordinate(chart_, f, j).terms)) {
        gradient_shared_[term.shared] += term.factor * t.gradient[j];
        for (int i = 0; i < 6; ++i) {
          const ChartCoordinate& c = coordinate(chart_, f, i);
          if (c.local >= 0) border_(c.local, term.shared) += c.sign * term.factor * t.hessian(i, j);
          for (const SharedTerm& other : chart_.sum(c.terms))
            corner_(other.shared, term.shared) += other.factor * term.factor * t.hessian(i, j);
        }
      }
    }
  }
}

void NewtonSystem::hold(int local) { held_[local] = 1, any_held_ = true; }

void NewtonSystem::apply(const Eigen::VectorXd& local, const Eigen::VectorXd& shared, Eigen::VectorXd& out_local,
                         Eigen::VectorXd& out_shared) const {
  out_local = lower_.selfadjointView<Eigen::Lower>() * local + border_ * shared;
  out_shared = border_.transpose() * local + corner_ * shared;
}

bool NewtonSystem::solve(NewtonStep& step, double damping, Context& context) {
  const int n = chart_.local_count(), k = shared_held_ ? 0 : chart_.shared_count();
  if (any_held_) {
    for (int j = 0; j < n; ++j)
      for (SparseMatrix::InnerIterator it(lower_, j); it; ++it)
        if (held_[j] || held_[it.row()]) it.valueRef() = it.row() == j ? 1.0 : 0.0;
    for (int j = 0; j < n; ++j)
      if (held_[j]) gradient_[j] = 0, border_.row(j).setZero();
  }
  SparseMatrix damped;
  if (damping > 0) {
    damped = lower_;
    for (int j = 0; j < n; ++j) damped.valuePtr()[damped.outerIndexPtr()[j]] *= 1 + damping;
  }
  try {
    const auto quiet = context.span(0, 0, "");  // how many solutions there will be is not known
    cholesky_.factorize(damping > 0 ? damped : lower_, context);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::could_not_solve) return false;
    throw;
  }
  Eigen::MatrixXd sides(n, k + 1);
  if (k > 0) sides.leftCols(k) = border_;
  sides.col(k) = -gradient_;
  cholesky_.solve(sides);
  step.local = sides.col(k);
  step.shared = Eigen::VectorXd::Zero(chart_.shared_count());
  if (k > 0) {
    const Eigen::MatrixXd schur = corner_ - border_.transpose() * sides.leftCols(k);
    const Eigen::LLT<Eigen::MatrixXd> factor(0.5 * (schur + schur.transpose()));
    if (factor.info() != Eigen::Success) return false;
    step.shared = factor.solve(-gradient_shared_ - border_.transpose() * step.local);
    step.local -= sides.leftCols(k) * step.shared;
  }
  step.slope = gradient_.dot(step.local) + (k > 0 ? gradient_shared_.dot(step.shared) : 0.0);
  return step.local.allFinite() && step.shared.allFinite();
}

}  // namespace formwright
