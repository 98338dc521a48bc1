// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/bounds/separators.h"

#include <algorithm>

namespace formwright {

void add_separators(const std::vector<InequalityRow>& rows, const std::vector<Separator>& kind,
                    const Eigen::VectorXd& feasible, double room, Eigen::VectorXd& lower, Eigen::VectorXd& upper) {
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (kind[k] == Separator::none) continue;
    const InequalityRow& row = rows[k];
    double slack = -row.bound, front = 0, behind = 0;  // and the sums of the coefficients on either side
    for (std::size_t j = 0; j < row.index.size(); ++j) {
      slack += row.coefficient[j] * feasible[row.index[j]];
      (row.coefficient[j] < 0 ? front : behind) += std::max(row.coefficient[j], -row.coefficient[j]);
    }
    const bool between = kind[k] == Separator::between;
    slack = (between ? 0.5 : 1.0) * std::max(slack, 0.0);
    for (std::size_t j = 0; j < row.index.size(); ++j) {
      const int i = row.index[j];
      if (row.coefficient[j] > 0) lower[i] = std::max(lower[i], feasible[i] - slack / behind - room);
      if (between && row.coefficient[j] < 0) upper[i] = std::min(upper[i], feasible[i] + slack / front + room);
    }
  }
}

}  // namespace formwright
