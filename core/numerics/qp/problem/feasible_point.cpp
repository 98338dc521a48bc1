// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/qp/problem/feasible_point.h"

#include <algorithm>

#include "base/index.h"

namespace formwright::bounded_qp_detail {

void move_inside(const Rows& rows, Eigen::VectorXd& u, Eigen::VectorXd& m) {
  const BoundedQpConstraints& c = rows.constraints();
  rows.clip(u, m);
  if (!c.start_satisfies_rows || c.start_u.size() != u.size() || c.start_m.size() != m.size()) return;
  double part = 0;
  for (std::size_t r = 0; r < c.rows.size(); ++r) {
    const RowKey key{Side::order, static_cast<int>(r)};
    const double missing = rows.deficit(key, u, m);
    if (!(missing > 0)) continue;
    const double room = -rows.deficit(key, c.start_u, c.start_m);
    part = std::max(part, room > 0 ? missing / (missing + room) : 1.0);
  }
  u += part * (c.start_u - u);
  m += part * (c.start_m - m);
  rows.clip(u, m);
}

}  // namespace formwright::bounded_qp_detail
