// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/block_cg.h"

#include <cmath>

#include "base/parallel.h"

namespace formwright {
namespace {

std::array<Float4, 3> inverse_of(const std::array<Float4, 3>& block) {
  const double a = block[0][0], b = block[1][0], c = block[2][0], d = block[1][1], e = block[2][1], f = block[2][2];
  const double aa = d * f - e * e, bb = c * e - b * f, cc = b * e - c * d;
  const double determinant = a * aa + b * bb + c * cc;
  // A block that rounding has made singular is replaced by its diagonal.
  if (!(determinant > 1e-12 * a * d * f)) {
    std::array<Float4, 3> result{};
    for (int k = 0; k < 3; ++k) result[static_cast<std::size_t>(k)][k] = block[static_cast<std::size_t>(k)][k] > 0 ? 1 / block[static_cast<std::size_t>(k)][k] : 0;
    return result;
  }
  const double s = 1 / determinant;
  const auto number = [&](double value) { return static_cast<float>(value * s); };
  const float xy = number(bb), xz = number(cc), yz = number(b * c - a * e);
  return {Float4{number(aa), xy, xz, 0}, Float4{xy, number(a * f - c * c), yz, 0}, Float4{xz, yz, number(a * d - b * b), 0}};
}

inline Float4 times(const std::array<Float4, 3>& m, const Float4& v) { return m[0] * v[0] + m[1] * v[1] + m[2] * v[2]; }

inline float dot(const Float4& a, const Float4& b) {
  const Float4 product = a * b;
  return product[0] + product[1] + product[2];
}

constexpr std::size_t row_grain = 512;

}  // namespace

BlockCg::BlockCg(int vertex_count) {
  const auto n = static_cast<std::size_t>(vertex_count);
  r_.resize(n);
  z_.resize(n);
  p_.resize(n);
  q_.resize(n);
  inverse_.resize(n);
}

int BlockCg::solve(const BlockMatrix& A, const BlockVector& right_side, std::span<const int> rows, double tolerance, int most_iterations, BlockVector& x) {
  std::fill(x.begin(), x.end(), Float4{});
  std::fill(p_.begin(), p_.end(), Float4{});
  partial_.resize(rows.size() / row_grain + 1);
  // The sum of what body(row) returns for every row; chunks of rows are summed one by one, so that threads do not matter.
  const auto sum_over_rows = [&](auto&& body) {
    parallel_for(rows.size(), row_grain, [&](std::size_t begin, std::size_t end) {
      double sum = 0;
      for (const int row : rows.subspan(begin, end - begin)) sum += static_cast<double>(body(row));
      partial_[begin / row_grain] = sum;
    });
    double sum = 0;
    for (std::size_t chunk = 0; chunk * row_grain < rows.size(); ++chunk) sum += partial_[chunk];
    return sum;
  };
  double rz = sum_over_rows([&](int row) {
    const auto i = static_cast<std::size_t>(row);
    inverse_[i] = inverse_of(A.block(A.diagonal_slot(row)));
    r_[i] = right_side[i];
    z_[i] = p_[i] = times(inverse_[i], r_[i]);
    return dot(r_[i], z_[i]);
  });
  const double enough = tolerance * tolerance * rz;
  int iteration = 0;
  while (iteration < most_iterations && rz > enough && rz > 0) {
    ++iteration;
    const double pq = sum_over_rows([&](int row) {
      const auto i = static_cast<std::size_t>(row);
      q_[i] = A.row_times(row, p_);
      return dot(p_[i], q_[i]);
    });
    if (!(pq > 0)) break;
    const auto alpha = static_cast<float>(rz / pq);
    const double next = sum_over_rows([&](int row) {
      const auto i = static_cast<std::size_t>(row);
      x[i] += alpha * p_[i];
      r_[i] -= alpha * q_[i];
      z_[i] = times(inverse_[i], r_[i]);
      return dot(r_[i], z_[i]);
    });
    const auto beta = static_cast<float>(next / rz);
    rz = next;
    parallel_for(rows.size(), row_grain, [&](std::size_t begin, std::size_t end) {
      for (const int row : rows.subspan(begin, end - begin)) {
        const auto i = static_cast<std::size_t>(row);
        p_[i] = z_[i] + beta * p_[i];
      }
    });
  }
  return iteration;
}

}  // namespace formwright
