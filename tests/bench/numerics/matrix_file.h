// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A sparse matrix in a file, so that programs and platforms factor the same bits: n and the number of entries (64-bit
// integers), n + 1 column starts, the row of each entry (32-bit integers), their values (doubles); little-endian.
#include <cstdint>
#include <fstream>
#include <stdexcept>
#include <string>

#include "numerics/sparse/sparse_cholesky.h"

namespace formwright::bench {

inline void write_matrix(const std::string& path, const SparseMatrix& lower) {
  std::ofstream file(path, std::ios::binary);
  const std::int64_t size[2] = {lower.rows(), lower.nonZeros()};
  const auto put = [&](const auto* data, std::int64_t count) {
    file.write(reinterpret_cast<const char*>(data),
               static_cast<std::streamsize>(static_cast<std::int64_t>(sizeof *data) * count));
  };
  put(size, 2), put(lower.outerIndexPtr(), size[0] + 1), put(lower.innerIndexPtr(), size[1]);
  put(lower.valuePtr(), size[1]);
  if (!file.flush()) throw std::runtime_error(path + " could not be written.");
}

inline SparseMatrix read_matrix(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::int64_t size[2] = {0, 0};
  const auto get = [&](auto* data, std::int64_t count) {
    file.read(reinterpret_cast<char*>(data),
              static_cast<std::streamsize>(static_cast<std::int64_t>(sizeof *data) * count));
  };
  get(size, 2);
  SparseMatrix lower(static_cast<Eigen::Index>(size[0]), static_cast<Eigen::Index>(size[0]));
  lower.resizeNonZeros(static_cast<Eigen::Index>(size[1]));
  get(lower.outerIndexPtr(), size[0] + 1), get(lower.innerIndexPtr(), size[1]), get(lower.valuePtr(), size[1]);
  if (!file) throw std::runtime_error(path + " could not be read.");
  return lower;
}

}  // namespace formwright::bench
