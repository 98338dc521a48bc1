// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/qp/exchange/exchange_pool_factor.h"

#include <algorithm>
#include <utility>

#include "base/error.h"
#include "base/index.h"
#include "numerics/dense/grown_cholesky.h"

namespace formwright::bounded_qp_detail {

namespace {
constexpr double max_proximal = 1e-5;
constexpr int min_border = 16;  // dropped rows are kept in L up to this number,
constexpr int border_part = 8;  // or up to this part of L
// Dropping a row that others nearly repeat through the border cancels digits that L without it keeps: round-off in y
// grows by (S'^-1)_aa S'_aa. A step of refinement gives back about as many digits as are left.
constexpr double max_cancellation = 1e10;
constexpr double matrix_by_vector = 5;  // times the seconds of a multiplication in a product of matrices
}  // namespace

PoolFactor::PoolFactor(Gram gram, const Eigen::VectorXd& row_diagonal, const Eigen::MatrixXd& B,
                       const Eigen::MatrixXd& P)
    : gram_(std::move(gram)), row_diagonal_(row_diagonal), B_(B), P_(P) {}

void PoolFactor::restart(int rows, double proximal) {
  proximal_ = proximal;
  order_.clear();
  place_.assign(index(rows), -1);
  dropped_.clear();
}

void PoolFactor::set_active(const std::vector<char>& active) {
  int leaving = 0;
  for (const int a : order_) leaving += active[index(a)] ? 0 : 1;
  const int old_size = size();
  if (leaving > std::max(min_border, size() / border_part)) {
    compact(active, old_size);
  } else {
    for (int a = 0; a < static_cast<int>(active.size()); ++a) {
      if (!active[index(a)] || place_[index(a)] >= 0) continue;
      place_[index(a)] = size();
      order_.push_back(a);
    }
    if (!grow(old_size) || !update_border(active, old_size)) compact(active, old_size);
  }
  factor_border();
}

// L of the active rows alone; of its first `valid` rows those before the first dropped one stay.
void PoolFactor::compact(const std::vector<char>& active, int valid) {
  std::vector<int> order;
  int from = valid;
  for (const int a : order_) {
    place_[index(a)] = -1;
    if (active[index(a)]) order.push_back(a);
    else from = std::min(from, static_cast<int>(order.size()));
  }
  for (std::size_t k = 0; k < order.size(); ++k) place_[index(order[k])] = static_cast<int>(k);
  for (int a = 0; a < static_cast<int>(active.size()); ++a) {
    if (!active[index(a)] || place_[index(a)] >= 0) continue;
    place_[index(a)] = static_cast<int>(order.size());
    order.push_back(a);
  }
  order_ = std::move(order);
  dropped_.clear();
  cancellation_ = 1;
  while (!grow(from)) {
    if (proximal_ >= max_proximal) {
      throw Error(ErrorCode::could_not_solve, "constraints",
                  "Two depth limits are numerically the same: remove duplicate vertices from the model.");
    }
    proximal_ *= 100;
    from = 0;
  }
}

// Rows and columns `from` and on of L, and of V. False if they are not positive definite to working precision.
bool PoolFactor::grow(int from) {
  const Eigen::Index k = size(), fresh = k - from;
  if (L_.rows() < k || V_.cols() != B_.cols()) {
    const Eigen::Index capacity = std::max<Eigen::Index>(k, L_.rows() + L_.rows() / 2);
    L_.conservativeResize(capacity, capacity);
    V_.conservativeResize(capacity, B_.cols());
  }
  if (fresh == 0) return true;
  const auto old = static_cast<double>(from), more = static_cast<double>(fresh);
  work_ += more * (0.5 * old * old + 0.5 * old * more + more * more / 6);
  for (int b = 0; b < size(); ++b) {
    const int first = std::max(b, from);
    gram_(order_[index(b)], std::span(order_).subspan(index(first)), &L_(first, b));
  }
  for (Eigen::Index a = from; a < k; ++a) L_(a, a) += proximal_ * row_diagonal_[order_[static_cast<std::size_t>(a)]];
  if (!dense::grow_cholesky(L_, from, k)) return false;
  for (Eigen::Index a = from; a < k; ++a) V_.row(a) = B_.row(order_[static_cast<std::size_t>(a)]);
  if (B_.cols() > 0) {
    auto below = V_.block(from, 0, fresh, B_.cols());
    if (from > 0) below.noalias() -= L_.block(from, 0, fresh, from) * V_.topRows(from);
    L_.block(from, from, fresh, fresh).triangularView<Eigen::Lower>().solveInPlace(below);
  }
  return true;
}

// Columns of U for the rows in L that are not active: rows that came back leave, the others grow with L, new ones are
// solved for. False if a column says that dropping its row this way would cost too many digits.
bool PoolFactor::update_border(const std::vector<char>& active, int old_size) {
  const Eigen::Index k = size(), fresh = k - old_size;
  Eigen::Index kept = 0;
  std::vector<int> dropped;
  for (std::size_t c = 0; c < dropped_.size(); ++c) {
    if (active[index(order_[index(dropped_[c])])]) continue;
    if (kept != static_cast<Eigen::Index>(c))
      U_.col(kept).head(old_size) = U_.col(static_cast<Eigen::Index>(c)).head(old_size);
    dropped.push_back(dropped_[c]);
    ++kept;
  }
  const std::vector<int> before = dropped;
  for (int p = 0; p < static_cast<int>(k); ++p) {
    if (!active[index(order_[index(p)])] && std::find(before.begin(), before.end(), p) == before.end())
      dropped.push_back(p);
  }
  const auto columns = static_cast<Eigen::Index>(dropped.size());
  if (U_.rows() < L_.rows() || U_.cols() < columns)
    U_.conservativeResize(L_.rows(), std::max<Eigen::Index>(columns, U_.cols() + U_.cols() / 2));
  if (kept > 0 && fresh > 0) {
    auto below = U_.block(old_size, 0, fresh, kept);
    below.noalias() = -L_.block(old_size, 0, fresh, old_size) * U_.topLeftCorner(old_size, kept);
    L_.block(old_size, old_size, fresh, fresh).triangularView<Eigen::Lower>().solveInPlace(below);
  }
  dropped_ = std::move(dropped);
  if (columns > kept) {
    // Solved together from the first place that any of them starts at.
    const int first = *std::min_element(dropped_.begin() + kept, dropped_.end());
    U_.block(0, kept, k, columns - kept).setZero();
    for (Eigen::Index c = kept; c < columns; ++c) U_(dropped_[static_cast<std::size_t>(c)], c) = 1;
    auto part = U_.block(first, kept, k - first, columns - kept);
    work_ +=
        0.5 * static_cast<double>(k - first) * static_cast<double>(k - first) * static_cast<double>(columns - kept);
    L_.block(first, first, k - first, k - first).triangularView<Eigen::Lower>().solveInPlace(part);
  }
  cancellation_ = 1;
  for (Eigen::Index c = 0; c < columns; ++c) {
    cancellation_ = std::max(cancellation_, U_.col(c).head(k).squaredNorm() *
                                                row_diagonal_[order_[index(dropped_[static_cast<std::size_t>(c)])]]);
  }
  return cancellation_ <= max_cancellation;
}

void PoolFactor::factor_border() {
  const Eigen::Index k = size(), d = B_.cols(), q = static_cast<Eigen::Index>(dropped_.size());
  Eigen::MatrixXd T(d + q, d + q);
  work_ += static_cast<double>(k) * static_cast<double>((d + q) * (d + q));
  const auto V = V_.topRows(k);
  T.topLeftCorner(d, d) = P_;
  if (k > 0) T.topLeftCorner(d, d).noalias() += V.transpose() * V;
  if (q > 0) {
    const auto U = U_.topLeftCorner(k, q);
    T.bottomLeftCorner(q, d).noalias() = U.transpose() * V;
    T.bottomRightCorner(q, q).noalias() = U.transpose() * U;
  }
  border_.compute(T);
}

void PoolFactor::solve(const Eigen::VectorXd& f, const Eigen::VectorXd& balance, Eigen::VectorXd& y,
                       Eigen::VectorXd& w) const {
  const Eigen::Index k = size(), d = B_.cols(), q = static_cast<Eigen::Index>(dropped_.size());
  Eigen::VectorXd x(k), z(d + q);
  work_ += matrix_by_vector * static_cast<double>(k * (k + 2 * (d + q)));
  for (Eigen::Index a = 0; a < k; ++a) x[a] = f[order_[static_cast<std::size_t>(a)]];
  for (const int p : dropped_) x[p] = 0;
  const auto L = L_.topLeftCorner(k, k).triangularView<Eigen::Lower>();
  if (k > 0) L.solveInPlace(x);
  if (d + q > 0) {
    const auto V = V_.topRows(k);
    z.head(d) = -balance;
    if (k > 0) z.head(d).noalias() += V.transpose() * x;
    if (q > 0) z.tail(q).noalias() = U_.topLeftCorner(k, q).transpose() * x;
    border_.solveInPlace(z);
    if (k > 0) x.noalias() -= V * z.head(d);
    if (q > 0) x.noalias() -= U_.topLeftCorner(k, q) * z.tail(q);
  }
  if (k > 0) L.transpose().solveInPlace(x);
  for (const int p : dropped_) x[p] = 0;
  w = z.head(d);
  y.setZero(B_.rows());
  for (Eigen::Index a = 0; a < k; ++a) y[order_[static_cast<std::size_t>(a)]] = x[a];
}

}  // namespace formwright::bounded_qp_detail
