// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/bounded_qp_crossover.h"

#include <algorithm>
#include <cmath>

namespace formwright::bounded_qp_detail {

namespace {
constexpr double sure = 1e4;  // (multiplier / typical multiplier) : (slack / typical slack) of a bound that surely holds
constexpr double matters = 1e-9;      // of the largest force: a reaction that ties a part to its bound
constexpr double round_off = 1e-11;  // of the largest force: a multiplier no smaller than minus this counts as zero
bool by_index(RowKey a, RowKey b) { return a.index < b.index; }
}  // namespace

std::vector<RowKey> add_base_reactions(const Energy& energy, const Rows& rows, std::span<const RowKey> base, ExchangeResult& result) {
  const Eigen::VectorXd reaction = energy.apply(result.u) - result.force;
  const double size = std::max(result.force.cwiseAbs().maxCoeff(), reaction.cwiseAbs().maxCoeff());
  const auto in_pool = static_cast<Eigen::Index>(result.active.size());
  result.multiplier.conservativeResize(in_pool + static_cast<Eigen::Index>(base.size()));
  std::vector<RowKey> pulling;
  for (std::size_t k = 0; k < base.size(); ++k) {
    const RowKey key = base[k];
    double push = key.side == Side::upper ? -reaction[key.index] : reaction[key.index];
    if (!rows.equality(key)) {
      if (push < -round_off * size) pulling.push_back(key);
      push = std::max(0.0, push);
    }
    result.active.push_back(key);
    result.multiplier[in_pool + static_cast<Eigen::Index>(k)] = push;
    if (rows.equality(key) || push > matters * size) result.pushing.push_back(key);
    rows.add_force(key, push, result.force);
  }
  std::sort(pulling.begin(), pulling.end(), by_index);
  return pulling;
}

std::optional<ExchangeResult> crossover(Energy& energy, const Rows& rows, const InteriorPointResult& point, const ExchangeSettings& settings,
                                        int& refactorisations, Context& context) {
  // Far from the optimum slack and multiplier of a row have typical sizes; their product goes to zero along the path,
  // so that one of the two is far below its size.
  const BoundedQpConstraints& c = rows.constraints();
  double typical_force = 0, typical_slack = 0;
  int forces = 0, slacks = 0;
  const auto survey = [&](double slack, double force) {
    if (force > slack * 1e-300) typical_force = std::max(typical_force, force), ++forces;
    typical_slack += slack, ++slacks;
  };
  for (int i = 0; i < rows.size(); ++i) {
    if (std::isfinite(c.lower[i])) survey(point.slack_lower[i], point.force_lower[i]);
    if (std::isfinite(c.upper[i])) survey(point.slack_upper[i], point.force_upper[i]);
  }
  typical_slack /= std::max(1, slacks);
  typical_force *= 0.1;
  ExchangeSettings own = settings;
  std::vector<RowKey> base;
  const auto place = [&](RowKey key, double slack, double force) {
    const double ratio = (force / typical_force) / (slack / typical_slack);
    if (ratio > sure && key.side != Side::order) base.push_back(key);
    else if (ratio > 1) own.first.push_back(key);
  };
  for (int i = 0; i < rows.size(); ++i) {
    if (c.lower[i] == c.upper[i] && c.lower_slope[i] == c.upper_slope[i]) {
      base.push_back({Side::both, i});
      continue;
    }
    const std::size_t before = base.size();
    if (std::isfinite(c.lower[i])) place({Side::lower, i}, point.slack_lower[i], point.force_lower[i]);
    if (base.size() == before && std::isfinite(c.upper[i])) place({Side::upper, i}, point.slack_upper[i], point.force_upper[i]);
  }
  for (std::size_t k = 0; k < point.order.size(); ++k) {
    const auto r = static_cast<Eigen::Index>(k);
    place({Side::order, point.order[k]}, point.order_slack[r], point.order_force[r]);
  }
  if (static_cast<int>(own.first.size()) > settings.most_active) return std::nullopt;

  BoundedQpSeconds seconds;
  for (;;) {
    ExchangeSolver exchange(energy);
    ExchangeResult result = exchange.solve(rows, base, own, context);
    ++refactorisations;
    seconds.factorise += result.seconds.factorise;
    seconds.columns += result.seconds.columns;
    seconds.pool += result.seconds.pool;
    seconds.sweeps += result.seconds.sweeps;
    if (result.stopped) return std::nullopt;
    const std::vector<RowKey> held = result.active;
    const std::vector<RowKey> pulling = add_base_reactions(energy, rows, base, result);
    if (!pulling.empty()) {
      own.first = held;
      std::erase_if(base, [&](RowKey key) { return std::binary_search(pulling.begin(), pulling.end(), key, by_index); });
      continue;
    }
    result.seconds = seconds;
    return result;
  }
}

}  // namespace formwright::bounded_qp_detail
