// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/qp/exchange/exchange_base.h"

namespace formwright::bounded_qp_detail {

namespace {
constexpr std::size_t many_equalities = 32;
}

std::vector<RowKey> base_of(const Rows& rows) {
  const BoundedQpConstraints& c = rows.constraints();
  std::vector<RowKey> base;
  for (int i = 0; i < rows.size(); ++i) {
    if (c.lower[i] == c.upper[i] && c.lower_slope[i] == c.upper_slope[i]) base.push_back({Side::both, i});
  }
  if (base.size() < many_equalities) base.clear();
  return base;
}

void add_base_reactions(const Energy& energy, const Rows& rows, const std::vector<RowKey>& base,
                        ExchangeResult& result) {
  const Eigen::VectorXd reaction = energy.apply(result.u) - result.force;
  const auto in_pool = static_cast<Eigen::Index>(result.active.size());
  result.multiplier.conservativeResize(in_pool + static_cast<Eigen::Index>(base.size()));
  for (std::size_t k = 0; k < base.size(); ++k) {
    const double push = reaction[base[k].index];
    result.active.push_back(base[k]);
    result.multiplier[in_pool + static_cast<Eigen::Index>(k)] = push;
    result.pushing.push_back(base[k]);
    rows.add_force(base[k], push, result.force);
  }
}

}  // namespace formwright::bounded_qp_detail
