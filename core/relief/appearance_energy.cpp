// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/appearance_energy.h"

#include <algorithm>

#include "base/parallel.h"
#include "geometry/operators/laplacian.h"

namespace formwright {

AppearanceEnergy::AppearanceEnergy(const ViewFrame& frame, const Triangles& F, const Eigen::VectorXd& weights) {
  const Eigen::Index n = frame.P.rows();
  const TriangleMesh mesh{frame.P, F};
  const SparseMatrix C = cotangent_laplacian(mesh);
  const Eigen::VectorXd A = vertex_areas(mesh);
  rays_ = frame.kappa * frame.P;
  rays_.col(2).array() += 1;
  row_weight_ = weights.array().square() / A.array();
  ring_start_.reserve(static_cast<std::size_t>(n) + 1);
  ring_.reserve(static_cast<std::size_t>(C.nonZeros()));
  ring_weight_.reserve(static_cast<std::size_t>(C.nonZeros()));
  star_sum_ = Positions::Zero(n, 3);
  ring_start_.push_back(0);
  for (int i = 0; i < n; ++i) {
    for (SparseMatrix::InnerIterator it(C, i); it; ++it)
      if (it.row() != i) {
        ring_.push_back(static_cast<int>(it.row()));
        ring_weight_.push_back(-it.value());
        star_sum_.row(i) -= it.value() * rays_.row(it.row());
      }
    ring_start_.push_back(static_cast<int>(ring_.size()));
  }
}

double AppearanceEnergy::operator()(const Eigen::VectorXd& u) const {
  double sum = 0;
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    Vec3 residual = Vec3::Zero();
    for (int k = ring_start_[static_cast<std::size_t>(i)]; k < ring_start_[static_cast<std::size_t>(i) + 1]; ++k) {
      const int j = ring_[static_cast<std::size_t>(k)];
      residual += ring_weight_[static_cast<std::size_t>(k)] * (u[j] - u[i]) * rays_.row(j).transpose();
    }
    sum += row_weight_[i] * residual.squaredNorm();
  }
  return sum;
}

SparseMatrix AppearanceEnergy::lower_hessian(Context& context) const {
  const std::size_t n = ring_start_.size() - 1;
  constexpr std::size_t grain = 4096;
  struct Columns {
    std::vector<int> count, row;
    std::vector<double> value;
  };
  std::vector<Columns> chunks((n + grain - 1) / grain);
  // Column k gathers, from every row i of M whose star holds k, the products with the rest of that star.
  parallel_for(n, grain, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    Columns& out = chunks[begin / grain];
    std::vector<double> sum(n, 0.0);
    std::vector<char> seen(n, 0);
    std::vector<int> touched;
    for (std::size_t k = begin; k < end; ++k) {
      touched.clear();
      const int column = static_cast<int>(k);
      const auto add = [&](int row, double value) {
        if (row < column) return;
        const auto r = static_cast<std::size_t>(row);
        if (!seen[r]) {
          seen[r] = 1;
          touched.push_back(row);
        }
        sum[r] += value;
      };
      const auto gather = [&](std::size_t i, const Vec3& coefficient) {
        const Vec3 weighted = row_weight_[static_cast<Eigen::Index>(i)] * coefficient;
        add(static_cast<int>(i), -weighted.dot(star_sum_.row(static_cast<Eigen::Index>(i)).transpose()));
        for (int e = ring_start_[i]; e < ring_start_[i + 1]; ++e) {
          const int j = ring_[static_cast<std::size_t>(e)];
          if (j >= column) add(j, ring_weight_[static_cast<std::size_t>(e)] * weighted.dot(rays_.row(j).transpose()));
        }
      };
      gather(k, -star_sum_.row(column).transpose());
      for (int e = ring_start_[k]; e < ring_start_[k + 1]; ++e)  // the ring is symmetric, and so are its weights
        gather(static_cast<std::size_t>(ring_[static_cast<std::size_t>(e)]),
               ring_weight_[static_cast<std::size_t>(e)] * rays_.row(column).transpose());
      add(column, 0.0);
      std::sort(touched.begin(), touched.end());
      out.count.push_back(static_cast<int>(touched.size()));
      for (const int row : touched) {
        out.row.push_back(row);
        out.value.push_back(sum[static_cast<std::size_t>(row)]);
        sum[static_cast<std::size_t>(row)] = 0;
        seen[static_cast<std::size_t>(row)] = 0;
      }
    }
  });

  std::size_t entries = 0;
  for (const Columns& chunk : chunks) entries += chunk.row.size();
  SparseMatrix Q(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
  Q.resizeNonZeros(static_cast<Eigen::Index>(entries));
  int* starts = Q.outerIndexPtr();
  std::size_t column = 0, done = 0;
  starts[0] = 0;
  for (Columns& chunk : chunks) {
    for (const int count : chunk.count) {
      starts[column + 1] = starts[column] + count;
      ++column;
    }
    std::copy(chunk.row.begin(), chunk.row.end(), Q.innerIndexPtr() + done);
    std::copy(chunk.value.begin(), chunk.value.end(), Q.valuePtr() + done);
    done += chunk.row.size();
    chunk = {};
  }
  return Q;
}

}  // namespace formwright
