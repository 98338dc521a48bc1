// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/dense/grown_cholesky.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "base/parallel.h"

namespace formwright::dense {

namespace {
constexpr Eigen::Index panel = 128;         // columns that are made together
constexpr std::size_t rows_per_task = 192;  // of a panel
}  // namespace

bool grow_cholesky(Eigen::MatrixXd& L, Eigen::Index from, Eigen::Index end) {
  for (Eigen::Index column = 0; column < end; column += panel) {
    const Eigen::Index width = std::min(panel, end - column), next = column + width;
    const auto update = [&](Eigen::Index row, Eigen::Index count) {
      L.block(row, column, count, width).noalias() -=
          L.block(row, 0, count, column) * L.block(column, 0, width, column).transpose();
    };
    const Eigen::Index top = std::max(column, from);
    if (top < next) {
      // Of the panel's own triangle, the rows that are new.
      const Eigen::Index old = top - column, fresh = next - top;
      update(top, fresh);
      if (old > 0) {
        auto left = L.block(top, column, fresh, old);
        L.block(column, column, old, old)
            .triangularView<Eigen::Lower>()
            .transpose()
            .solveInPlace<Eigen::OnTheRight>(left);
        L.block(top, top, fresh, fresh).selfadjointView<Eigen::Lower>().rankUpdate(left, -1);
      }
      Eigen::Ref<Eigen::MatrixXd> corner = L.block(top, top, fresh, fresh);
      if (Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(corner).info() != Eigen::Success) return false;
    }
    const Eigen::Index below = std::max(next, from);
    parallel_for(static_cast<std::size_t>(end - below), rows_per_task, [&](std::size_t begin, std::size_t stop) {
      const Eigen::Index row = below + static_cast<Eigen::Index>(begin),
                         count = static_cast<Eigen::Index>(stop - begin);
      if (column > 0) update(row, count);
      auto part = L.block(row, column, count, width);
      L.block(column, column, width, width)
          .triangularView<Eigen::Lower>()
          .transpose()
          .solveInPlace<Eigen::OnTheRight>(part);
    });
  }
  return true;
}

}  // namespace formwright::dense
