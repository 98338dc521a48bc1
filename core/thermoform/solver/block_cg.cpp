// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/solver/block_cg.h"

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
    for (int k = 0; k < 3; ++k)
      result[static_cast<std::size_t>(k)][k] =
          block[static_cast<std::size_t>(k)][k] > 0 ? 1 / block[static_cast<std::size_t>(k)][k] : 0;
    return result;
  }
  const double s = 1 / determinant;
  const auto number = [&](double value) { return static_cast<float>(value * s); };
  const float xy = number(bb), xz = number(cc), yz = number(b * c - a * e);
  return {Float4{number(aa), xy, xz, 0}, Float4{xy, number(a * f - c * c), yz, 0},
          Float4{xz, yz, number(a * d - b * b), 0}};
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

int BlockCg::solve(const BlockMatrix& A, const BlockVector& right_side, std::span<const int> rows, double tolerance,
                   int max_iterations, BlockVector& x) {
  std::fill(x.begin(), x.end(), Float4{});
  std::fill(p_.begin(), p_.end(), Float4{});
  partial_.resize(rows.size() / row_grain + 1);
  // By plain pointers: what is written must not make the compiler look up where the vectors are.
  const BlockMatrix::Rows matrix = A.rows();
  Float4 *const solution = x.data(), *const residual = r_.data(), *const preconditioned = z_.data(),
                *const direction = p_.data(), *const image = q_.data();
  std::array<Float4, 3>* const inverse = inverse_.data();
  // The sum of what body(i) returns for every row i; chunks of rows are summed one by one, so that threads do not
  // matter.
  const auto sum_over_rows = [&](const auto& body) {
    parallel_for(rows.size(), row_grain, [&](std::size_t begin, std::size_t end) {
      const auto each = body;
      double sum = 0;
      for (const int row : rows.subspan(begin, end - begin))
        sum += static_cast<double>(each(static_cast<std::size_t>(row)));
      partial_[begin / row_grain] = sum;
    });
    double sum = 0;
    for (std::size_t chunk = 0; chunk * row_grain < rows.size(); ++chunk) sum += partial_[chunk];
    return sum;
  };
  double rz = sum_over_rows([=, &A, &right_side](std::size_t i) {
    inverse[i] = inverse_of(A.block(A.diagonal_slot(static_cast<int>(i))));
    residual[i] = right_side[i];
    preconditioned[i] = direction[i] = times(inverse[i], residual[i]);
    return dot(residual[i], preconditioned[i]);
  });
  const double enough = tolerance * tolerance * rz;
  int iteration = 0;
  while (iteration < max_iterations && rz > enough && rz > 0) {
    ++iteration;
    const double pq = sum_over_rows([=](std::size_t i) {
      image[i] = matrix.times(i, direction);
      return dot(direction[i], image[i]);
    });
    if (!(pq > 0)) break;
    const auto alpha = static_cast<float>(rz / pq);
    const double next = sum_over_rows([=](std::size_t i) {
      solution[i] += alpha * direction[i];
      residual[i] -= alpha * image[i];
      preconditioned[i] = times(inverse[i], residual[i]);
      return dot(residual[i], preconditioned[i]);
    });
    const auto beta = static_cast<float>(next / rz);
    rz = next;
    parallel_for(rows.size(), row_grain, [=](std::size_t begin, std::size_t end) {
      for (const int row : rows.subspan(begin, end - begin)) {
        const auto i = static_cast<std::size_t>(row);
        direction[i] = preconditioned[i] + beta * direction[i];
      }
    });
  }
  return iteration;
}

}  // namespace formwright
