// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/qp/problem/bounded_qp_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/error.h"
#include "base/index.h"
#include "base/parallel.h"

namespace formwright::bounded_qp_detail {

namespace {
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::size_t unknowns_per_chunk = 8192;
constexpr std::ptrdiff_t few =
    100;  // violated bounds that enter together: it saves the last rounds, which creep from neighbour to neighbour
[[noreturn]] void reject(const std::string& where, const std::string& message) {
  throw Error(ErrorCode::invalid_input, where, message);
}
}  // namespace

Rows::Rows(const BoundedQpConstraints& constraints, const Energy& energy) : c_(constraints), energy_(energy) {
  check();
  double low = infinity, high = -infinity;
  for (int i = 0; i < size(); ++i) {
    for (const double b : {c_.lower[i], c_.upper[i]}) {
      if (!std::isfinite(b)) continue;
      low = std::min(low, b);
      high = std::max(high, b);
    }
  }
  for (const InequalityRow& row : c_.rows)
    high = std::max(high, std::isfinite(low) ? low + std::abs(row.bound) : std::abs(row.bound));
  if (!std::isfinite(low)) low = 0;
  scale_ = std::max({high - low, 1e-300});
  if (!std::isfinite(scale_)) scale_ = 1;
}

void Rows::check() const {
  const auto n = static_cast<Eigen::Index>(energy_.size());
  const std::string want = "Give one value for each of the " + std::to_string(n) + " unknowns.";
  if (c_.lower.size() != n) reject("lower", want);
  if (c_.upper.size() != n) reject("upper", want);
  if (c_.lower_slope.size() != n) reject("lower_slope", want);
  if (c_.upper_slope.size() != n) reject("upper_slope", want);
  if (c_.gauge.size() != n) reject("gauge", want);
  if (c_.group.size() != static_cast<std::size_t>(n)) reject("group", want);
  if (c_.group_count < 1) reject("group_count", "A quadratic program needs at least one group of unknowns.");
  if (!c_.gauge.allFinite()) reject("gauge", "The gauge of a quadratic program must be finite.");
  if (!c_.lower_slope.allFinite()) reject("lower_slope", "The slopes of a quadratic program must be finite.");
  if (!c_.upper_slope.allFinite()) reject("upper_slope", "The slopes of a quadratic program must be finite.");
  // Each pair of bounds asks (upper_slope - lower_slope) m >= lower - upper: a half line of m, or nothing.
  std::vector<double> minimum(index(c_.group_count), -infinity), maximum(index(c_.group_count), infinity);
  int crossed = 0;
  for (int i = 0; i < size(); ++i) {
    const double lower = c_.lower[i], upper = c_.upper[i];
    if (std::isnan(lower) || lower == infinity) reject("lower", "A lower bound must be a number or minus infinity.");
    if (std::isnan(upper) || upper == -infinity) reject("upper", "An upper bound must be a number or plus infinity.");
    const int g = c_.group[index(i)];
    if (g < 0 || g >= c_.group_count)
      reject("group", "The groups of a quadratic program must be numbered from 0 to group_count - 1.");
    if (lower == -infinity || upper == infinity) continue;
    const double gap = lower - upper, slope = c_.upper_slope[i] - c_.lower_slope[i];
    if (slope > 0) minimum[index(g)] = std::max(minimum[index(g)], gap / slope);
    else if (slope < 0) maximum[index(g)] = std::min(maximum[index(g)], gap / slope);
    else if (gap > 0) ++crossed;
  }
  if (crossed > 0) {
    reject("lower", "The lower bound is above the upper bound for " + std::to_string(crossed) +
                        " unknowns: raise the upper or lower the lower bound.");
  }
  for (std::size_t g = 0; g < minimum.size(); ++g) {
    if (minimum[g] > maximum[g] + 1e-12 * (std::abs(minimum[g]) + std::abs(maximum[g]))) {
      throw Error(
          ErrorCode::could_not_solve, "lower",
          "No offset lets the bounds of group " + std::to_string(g) + " open for all its unknowns: widen them.");
    }
  }
  for (const InequalityRow& row : c_.rows) {
    if (row.index.size() != row.coefficient.size())
      reject("rows", "A constraint needs one coefficient for each index.");
    if (row.group < 0 || row.group >= c_.group_count)
      reject("rows", "A constraint refers to a group that does not exist.");
    if (!std::isfinite(row.slope) || std::isnan(row.bound) || row.bound == infinity)
      reject("rows", "A constraint holds a value that is not finite.");
    for (const int i : row.index) {
      if (i < 0 || i >= size()) reject("rows", "A constraint refers to an unknown that does not exist.");
    }
    for (const double a : row.coefficient) {
      if (!std::isfinite(a)) reject("rows", "A constraint holds a value that is not finite.");
    }
  }
}

int Rows::group(RowKey key) const {
  return key.side == Side::order ? c_.rows[index(key.index)].group : c_.group[index(key.index)];
}

double Rows::bound(RowKey key) const {
  switch (key.side) {
    case Side::upper: return -c_.upper[key.index];
    case Side::order: return c_.rows[index(key.index)].bound;
    default: return c_.lower[key.index];
  }
}

double Rows::slope(RowKey key) const {
  switch (key.side) {
    case Side::upper: return c_.upper_slope[key.index];
    case Side::order: return c_.rows[index(key.index)].slope;
    default: return -c_.lower_slope[key.index];
  }
}

double Rows::apply(RowKey key, const Eigen::VectorXd& v) const {
  if (key.side == Side::upper) return -v[key.index];
  if (key.side != Side::order) return v[key.index];
  const InequalityRow& row = c_.rows[index(key.index)];
  double sum = 0;
  for (std::size_t k = 0; k < row.index.size(); ++k) sum += row.coefficient[k] * v[row.index[k]];
  return sum;
}

void Rows::add_force(RowKey key, double y, Eigen::VectorXd& f) const {
  if (key.side == Side::upper) f[key.index] -= y;
  else if (key.side != Side::order) f[key.index] += y;
  else {
    const InequalityRow& row = c_.rows[index(key.index)];
    for (std::size_t k = 0; k < row.index.size(); ++k) f[row.index[k]] += y * row.coefficient[k];
  }
}

double Rows::deficit(RowKey key, const Eigen::VectorXd& u, const Eigen::VectorXd& m) const {
  return bound(key) - slope(key) * m[group(key)] - apply(key, u);
}

double Rows::violation(RowKey key, const Eigen::VectorXd& u, const Eigen::VectorXd& m) const {
  const double v = deficit(key, u, m);
  return equality(key) ? std::abs(v) : v;
}

void Rows::evaluate(const Eigen::VectorXd& u, const Eigen::VectorXd& m, Violations& out) const {
  const std::size_t n = index(size());
  out.bound.resize(n);
  out.side.resize(n);
  out.order.resize(c_.rows.size());
  std::vector<double> worst((n + unknowns_per_chunk - 1) / unknowns_per_chunk, 0.0);
  parallel_for(n, unknowns_per_chunk, [&](std::size_t begin, std::size_t end) {
    double maximum = 0;
    for (std::size_t k = begin; k < end; ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      const double mg = m[c_.group[k]];
      const double below = c_.lower[i] + c_.lower_slope[i] * mg - u[i],
                   above = u[i] - (c_.upper[i] + c_.upper_slope[i] * mg);
      out.bound[k] = std::max(below, above);
      out.side[k] = below > above ? Side::lower : Side::upper;
      if (out.bound[k] > 0 && c_.lower[i] == c_.upper[i] && c_.lower_slope[i] == c_.upper_slope[i])
        out.side[k] = Side::both;
      maximum = std::max(maximum, out.bound[k]);
    }
    worst[begin / unknowns_per_chunk] = maximum;
  });
  out.max = worst.empty() ? 0 : *std::max_element(worst.begin(), worst.end());
  out.max_order = 0;
  for (std::size_t r = 0; r < c_.rows.size(); ++r) {
    out.order[r] = violation({Side::order, static_cast<int>(r)}, u, m);
    out.max_order = std::max(out.max_order, out.order[r]);
  }
  out.max = std::max(out.max, out.max_order);
}

std::vector<RowKey> Rows::worth_adding(const Violations& v, double minimum) const {
  std::vector<std::pair<double, RowKey>> found;
  const bool all = std::count_if(v.bound.begin(), v.bound.end(), [&](double x) { return x > minimum; }) <= few;
  for (int i = 0; i < size(); ++i) {
    const double here = v.bound[index(i)];
    if (!(here > minimum)) continue;
    const Side side = v.side[index(i)];
    bool highest = true;
    if (side != Side::both && !all) {
      for (const int j : energy_.neighbours(i)) {
        const double there = v.bound[index(j)];
        if (v.side[index(j)] == side && (there > here || (there == here && j < i))) {
          highest = false;
          break;
        }
      }
    }
    if (highest) found.push_back({here, {side, i}});
  }
  if (v.max_order > minimum) {
    std::vector<double> maximum(index(size()), 0.0);
    for (std::size_t r = 0; r < c_.rows.size(); ++r) {
      for (const int i : c_.rows[r].index) maximum[index(i)] = std::max(maximum[index(i)], v.order[r]);
    }
    for (std::size_t r = 0; r < c_.rows.size(); ++r) {
      if (!(v.order[r] > minimum)) continue;
      const auto& unknowns = c_.rows[r].index;
      if (std::all_of(unknowns.begin(), unknowns.end(), [&](int i) { return maximum[index(i)] <= v.order[r]; })) {
        found.push_back({v.order[r], {Side::order, static_cast<int>(r)}});
      }
    }
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<RowKey> keys;
  for (const auto& [violation, key] : found) keys.push_back(key);
  return keys;
}

void Rows::clip(Eigen::VectorXd& u, const Eigen::VectorXd& m) const {
  for (int i = 0; i < size(); ++i) {
    const double mg = m[c_.group[index(i)]];
    const double low = c_.lower[i] + c_.lower_slope[i] * mg, high = c_.upper[i] + c_.upper_slope[i] * mg;
    u[i] = std::min(std::max(u[i], low), high);
  }
}

Eigen::VectorXd Rows::centred_m() const {
  // u = 0 asks upper + upper_slope m >= 0 and lower + lower_slope m <= 0: from where each alone would push m.
  Eigen::VectorXd m = Eigen::VectorXd::Zero(groups());
  std::vector<double> up(index(groups()), -infinity), down(index(groups()), infinity);
  for (int i = 0; i < size(); ++i) {
    const std::size_t g = index(c_.group[index(i)]);
    if (std::isfinite(c_.upper[i]) && c_.upper_slope[i] > 0) up[g] = std::max(up[g], -c_.upper[i] / c_.upper_slope[i]);
    if (std::isfinite(c_.lower[i]) && c_.lower_slope[i] > 0)
      down[g] = std::min(down[g], -c_.lower[i] / c_.lower_slope[i]);
  }
  for (int g = 0; g < groups(); ++g) {
    const double a = up[index(g)], b = down[index(g)];
    if (std::isfinite(a) && std::isfinite(b)) m[g] = a <= b ? std::clamp(0.0, a, b) : 0.5 * (a + b);
    else if (std::isfinite(a)) m[g] = std::max(0.0, a);
    else if (std::isfinite(b)) m[g] = std::min(0.0, b);
  }
  return m;
}

}  // namespace formwright::bounded_qp_detail
