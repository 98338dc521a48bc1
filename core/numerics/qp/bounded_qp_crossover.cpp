// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/qp/bounded_qp_crossover.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "numerics/qp/bounded_qp_base.h"

namespace formwright::bounded_qp_detail {

namespace {
constexpr double sure =
    1e4;  // (multiplier / typical multiplier) : (slack / typical slack) of a bound that surely holds
constexpr int max_stages = 60;
}  // namespace

std::optional<ExchangeResult> crossover(Energy& energy, const Rows& rows, const InteriorPointResult& point,
                                        const ExchangeSettings& settings, Context& context) {
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
    if (base.size() == before && std::isfinite(c.upper[i]))
      place({Side::upper, i}, point.slack_upper[i], point.force_upper[i]);
  }
  for (std::size_t k = 0; k < point.order.size(); ++k) {
    const auto r = static_cast<Eigen::Index>(k);
    place({Side::order, point.order[k]}, point.order_slack[r], point.order_force[r]);
  }
  return exchange_on_base(energy, rows, std::move(base), std::move(own), max_stages, context);
}

}  // namespace formwright::bounded_qp_detail
