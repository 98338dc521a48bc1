// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/qp/bounded_qp_base.h"

#include <algorithm>
#include <cmath>

namespace formwright::bounded_qp_detail {

namespace {
constexpr double matters = 1e-9;     // of the largest force: a reaction that ties a part to its bound
constexpr double round_off = 1e-11;  // of the largest force: a multiplier no smaller than minus this counts as zero
bool by_index(RowKey a, RowKey b) { return a.index < b.index; }
}  // namespace

std::vector<RowKey> add_base_reactions(const Energy& energy, const Rows& rows, std::span<const RowKey> base,
                                       ExchangeResult& result) {
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

std::optional<ExchangeResult> exchange_on_base(Energy& energy, const Rows& rows, std::vector<RowKey> base,
                                               ExchangeSettings settings, int max_stages, Context& context) {
  settings.may_stop = true;
  const int max_active = settings.max_active;
  std::vector<char> kept_out(static_cast<std::size_t>(energy.size()), 0);  // unknowns of order rows that matter
  int kept_out_count = 0;
  const auto keep_out = [&](RowKey order) {
    for (const int i : rows.constraints().rows[static_cast<std::size_t>(order.index)].index) {
      char& flag = kept_out[static_cast<std::size_t>(i)];
      kept_out_count += flag ? 0 : 1;
      flag = 1;
    }
  };
  // What may not be on the base goes to the pool.
  const auto clear_base = [&] {
    std::erase_if(base, [&](RowKey key) {
      if (!kept_out[static_cast<std::size_t>(key.index)] || rows.equality(key)) return false;
      settings.first.push_back(key);
      return true;
    });
    settings.max_active = max_active + kept_out_count;
  };
  for (const RowKey key : settings.first) {
    if (key.side == Side::order) keep_out(key);
  }
  clear_base();
  BoundedQpSeconds seconds;
  std::vector<BoundedQpRound> history;
  int rounds = 0;
  for (int stage = 0; stage < max_stages; ++stage) {
    ExchangeSolver exchange(energy);
    ExchangeResult result = exchange.solve(rows, base, settings, context);
    seconds.factorise += result.seconds.factorise;
    seconds.columns += result.seconds.columns;
    seconds.pool += result.seconds.pool;
    seconds.sweeps += result.seconds.sweeps;
    rounds += result.rounds;
    for (BoundedQpRound& round : result.history) {
      round.active += static_cast<int>(base.size());
      history.push_back(round);
    }
    const std::vector<RowKey> held = result.active;
    const std::vector<RowKey> pulling = add_base_reactions(energy, rows, base, result);
    if (pulling.empty() && !result.stopped) {
      result.seconds = seconds;
      result.history = std::move(history);
      result.rounds = rounds;
      return result;
    }
    std::erase_if(base, [&](RowKey key) { return std::binary_search(pulling.begin(), pulling.end(), key, by_index); });
    settings.first = result.blocked;
    for (const RowKey key : result.blocked) keep_out(key);
    const bool full = static_cast<int>(held.size()) > settings.max_active;
    for (const RowKey key : held) {
      if (full && (key.side == Side::lower || key.side == Side::upper)) base.push_back(key);
      else settings.first.push_back(key);
      if (key.side == Side::order) keep_out(key);
    }
    clear_base();
  }
  return std::nullopt;
}

}  // namespace formwright::bounded_qp_detail
